//! Scenes and cases that do not fit each other: told before a run starts.

use super::good;
use amberfield_tests::FoamBox;

#[test]
fn a_case_without_a_potential_is_refused_before_anything_about_charges() {
    for charge in ["bipolar = 1e-12", "constant = 1e-12"] {
        let scene = FoamBox::grounded();
        let text = scene.bench.read("scene.toml").replace("bipolar = 1e-12", charge);
        scene.bench.write("scene.toml", &text);
        std::fs::remove_file(scene.bench.path("foam/0/phiE")).unwrap();
        let flow = ["--set", "gas={flow='solver',interval_s=1e-4}"];
        for command in ["run", "explain", "field"] {
            let out = ["--out", "out"];
            let out = if command == "explain" { &[][..] } else { &out };
            for more in [&[][..], &flow] {
                let answer = scene.bench.run(&[&[command, "scene.toml"], out, more].concat());
                assert_eq!(answer.code, Some(2), "{}", answer.stderr);
                let mut errors = answer.stderr.lines().filter(|line| line.starts_with("error: "));
                let (first, line) = (errors.next().unwrap(), text.lines().count() - 1);
                let place = format!("error: scene.toml:{line}: solver.openfoam_case = \"foam\": ");
                assert!(first.starts_with(&place) && first.contains("no potential 0/phiE"), "{first}");
                assert_eq!(errors.count(), 0, "{}", answer.stderr);
            }
        }
    }
}

#[test]
fn a_box_that_is_larger_than_the_mesh_is_told_at_the_start() {
    let scene = FoamBox::grounded();
    // Grains keep clear of what the mesh does not have.
    let inside = "particles.generate.region={box={min_m=[0,0,0],max_m=[0.012,0.012,0.009]}}";
    for (top, words) in [
        ("0.01", None),
        (
            "0.011",
            Some("[domain] reaches from 0 to 0.011 m along z, the mesh of [solver] only from 0 to 0.01 m"),
        ),
    ] {
        let top = format!("domain.max_m=[0.012,0.012,{top}]");
        for command in [&["explain", "scene.toml"][..], &["run", "scene.toml", "--steps", "2", "--overwrite"]]
        {
            let answer = scene.bench.run(&[command, &["--set", &top, "--set", inside]].concat());
            good(&answer);
            let said = answer.stdout + &answer.stderr;
            assert_eq!(said.matches("[domain] reaches from").count(), usize::from(words.is_some()), "{said}");
            assert!(words.is_none_or(|words| said.contains(words)), "{said}");
        }
    }
}
