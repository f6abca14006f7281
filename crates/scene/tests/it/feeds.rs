//! Feeds: their grains are drawn with the scene, more of them where the run ends later, in any order.

use crate::common::Folder;
use amberfield_core::{FeedRegion, Feeds, OnBlocked, Volume};
use amberfield_scene::Purpose;

const SCENE: &str = r#"
[domain]
min_m = [0, 0, 0]
max_m = [0.1, 0.1, 0.2]
boundary = { x = "open", y = "open", z = "open" }
[[materials]]
name = "glass"
density_kg_m3 = 2500.0
young_Pa = 1e7
poisson = 0.22
restitution = 0.9
friction = 0.3
[time]
step_s = 1e-5
end_s = 0.15
[[feeds]]
name = "left"
region = { box = { min_m = [0.01, 0.01, 0.15], max_m = [0.09, 0.09, 0.19] } }
rate_kg_s = 5e-3
radius_m = { uniform = { min = 2e-4, max = 4e-4 } }
charge_C = { normal = { mean = 0.0, std = 1e-14 } }
velocity_m_s = [0, 0, -1]
velocity_spread_m_s = 0.1
seed = 3
[[feeds]]
name = "fines"
region = { cylinder = { base_m = [0.05, 0.05, 0.1], top_m = [0.05, 0.05, 0.14], radius_m = 0.03 } }
rate_per_s = 2000.0
radius_m = { by_mass = [[1e-4, 0.3], [2e-4, 0.7]] }
charge_C_kg = { bipolar = 1e-6 }
group = "fine"
on_blocked = "stop"
start_s = 0.05
"#;

fn feeds(text: &str, overrides: &[&str]) -> Feeds {
    let folder = Folder::good();
    folder.write("scene.toml", text);
    folder.read(overrides).unwrap_or_else(|error| panic!("{error}")).feeds
}

fn refusal(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "{from}");
    let folder = Folder::good();
    folder.write("scene.toml", SCENE.replacen(from, to, 1));
    folder.refusal(&[])
}

#[test]
fn rates_and_sizes_are_kept() {
    let read = feeds(SCENE, &[]);
    assert_eq!(read.list.iter().map(|feed| feed.name.as_str()).collect::<Vec<_>>(), ["fines", "left"]);
    let FeedRegion::Volume(Volume::Cylinder { length, .. }) = read.list[0].region else { panic!("a tube") };
    assert!((length - 0.04).abs() < 1e-12);
    assert_eq!([read.list[0].on_blocked, read.list[1].on_blocked], [OnBlocked::Stop, OnBlocked::Wait]);
    assert!(read.due_s.is_sorted() && read.grains.id.is_sorted_by(|a, b| a < b));
    let of = |feed: u16| (0..read.due_s.len()).filter(|k| read.feed[*k] == feed).collect::<Vec<_>>();
    let (fines, left) = (of(0), of(1));
    // 5e-3 kg/s over 0.15 s, to a grain.
    let mass: f64 = left.iter().map(|k| read.grains.mass(*k)).sum();
    assert!((7.5e-4..7.5e-4 + 7e-7).contains(&mass), "{mass:e}");
    assert!(left.iter().all(|k| (2e-4..=4e-4).contains(&read.grains.radius[*k])));
    // 2000 1/s from 0.05 s on, with shares by mass.
    assert!(fines.len().abs_diff(200) <= 1, "{}", fines.len());
    assert!(fines.iter().all(|k| read.due_s[*k] >= 0.05));
    let of_large = fines.iter().filter(|k| read.grains.radius[**k] == 2e-4).map(|k| read.grains.mass(*k));
    let (large, all): (f64, f64) = (of_large.sum(), fines.iter().map(|k| read.grains.mass(*k)).sum());
    assert!((large / all - 0.7).abs() < 0.03, "{}", large / all);
    for k in &fines {
        let ratio = read.grains.charge[*k] / read.grains.mass(*k);
        assert!((ratio.abs() - 1e-6).abs() < 1e-15, "{ratio:e}");
    }
    let net: f64 = fines.iter().map(|k| read.grains.charge[*k] / read.grains.mass(*k)).sum();
    assert!(net.abs() <= 1.01e-6, "{net:e}");
    let speeds = left.iter().map(|k| (read.grains.velocity[*k].z + 1.0).abs()).fold(0.0, f64::max);
    assert!(speeds > 0.1 && speeds <= 0.3, "{speeds}");
}

#[test]
fn a_later_end_adds_grains_and_the_order_of_feeds_does_not_matter() {
    let (short, long) = (feeds(SCENE, &[]), feeds(SCENE, &["time.end_s=0.3"]));
    let count = short.due_s.len();
    assert!(long.due_s.len() > count + 100);
    let first: amberfield_core::Particles = (0..count).map(|k| long.grains.grain(k)).collect();
    assert_eq!(first, short.grains);
    assert_eq!(long.due_s[..count], short.due_s);
    let (head, tables) = SCENE.split_once("[[feeds]]").unwrap();
    let (left, fines) = tables.split_once("[[feeds]]").unwrap();
    let turned = format!("{head}[[feeds]]{fines}[[feeds]]{left}");
    assert_eq!(feeds(&turned, &[]), short);
    // Another distribution of charges leaves sizes and times as they are.
    let other = feeds(&SCENE.replace("std = 1e-14", "std = 2e-14"), &[]);
    assert_eq!((&other.grains.radius, &other.due_s), (&short.grains.radius, &short.due_s));
}

#[test]
fn totals_and_counts_end_a_feed() {
    let text = SCENE.replace("seed = 3", "seed = 3\ntotal_kg = 1e-4").replace("start_s = 0.05", "count = 17");
    let read = feeds(&text, &[]);
    assert_eq!(read.feed.iter().filter(|feed| **feed == 0).count(), 17);
    let left = (0..read.due_s.len()).filter(|k| read.feed[*k] == 1);
    let mass: f64 = left.map(|k| read.grains.mass(k)).sum();
    assert!((1e-4..1e-4 + 7e-7).contains(&mass), "{mass:e}");
}

#[test]
fn bad_feeds_are_refused_with_advice() {
    for (from, to, words) in [
        ("rate_kg_s = 5e-3", "", &["feeds[0].rate_kg_s", "rate_per_s"][..]),
        ("rate_kg_s = 5e-3", "rate_kg_s = 5e-3\nrate_per_s = 1.0", &["rate_per_s", "exactly one"]),
        ("rate_kg_s = 5e-3", "rate_kg_s = 0.0", &["rate_kg_s", "above 0"]),
        ("rate_kg_s = 5e-3", "rate_kg_s = 1e11", &["feed \"left\"", "kept in memory"]),
        ("rate_kg_s = 5e-3", "mass_rate = 5e-3", &["rate_kg_s"]),
        ("name = \"left\"", "name = \"fines\"", &["another feed has this name"]),
        ("name = \"left\"", "", &["feeds[0].name"]),
        ("charge_C_kg =", "charge_C = 1e-14\ncharge_C_kg =", &["charge_C_kg", "at most one"]),
        ("start_s = 0.05", "start_s = 0.5", &["feed \"fines\"", "brings no grain"]),
        ("start_s = 0.05", "start_s = 0.05\nend_s = 0.04", &["end_s", "start_s"]),
        ("[[1e-4, 0.3], [2e-4, 0.7]]", "[[1e-4, 0.3], [2e-4]]", &["by_mass", "pairs [a, b]"]),
        ("[[1e-4, 0.3], [2e-4, 0.7]]", "[]", &["by_mass", "no pair"]),
        ("cylinder = {", "stl = \"no.stl\", cylinder = {", &["region.stl", "another shape"]),
        ("cylinder = {", "scale = 2.0, cylinder = {", &["region.scale"]),
        ("on_blocked = \"stop\"", "on_blocked = \"fail\"", &["on_blocked", "\"wait\", \"stop\""]),
    ] {
        let said = refusal(from, to);
        for word in words {
            assert!(said.contains(word), "{to}: no {word:?} in {said}");
        }
    }
}

#[test]
fn grains_at_the_start_are_not_needed_where_feeds_are() {
    let folder = Folder::good();
    folder.write("scene.toml", SCENE.replace("[time]", "[particles]\non_exit = \"delete\"\n[time]"));
    let scene = folder.read(&[]).unwrap();
    assert!(scene.particles.is_empty() && scene.groups == ["all", "fine"]);
    folder.write("scene.toml", SCENE.replace("[[feeds]]", "[[nothing]]"));
    assert!(folder.read_for(Purpose::Run, &[]).is_err());
    let (without, _) = SCENE.split_once("[[feeds]]").unwrap();
    folder.write("scene.toml", without);
    assert!(folder.refusal(&[]).contains("missing key particles"));
}

#[test]
fn sizes_by_mass_are_generated_too() {
    let folder = Folder::good();
    let (head, _) = SCENE.split_once("[[feeds]]").unwrap();
    folder.write(
        "scene.toml",
        format!(
            "{head}[particles.generate]\ncount = 900\nradius_m = {{ by_mass = [[1e-3, 0.5], [2e-3, 0.5]] }}\n"
        ),
    );
    let grains = folder.read(&[]).unwrap().particles;
    // As much mass in an eighth of the number.
    assert_eq!(grains.radius.iter().filter(|radius| **radius == 2e-3).count(), 100);
}
