//! Lists of tables: empty ones are none, and another kind of value is told how to write it.

use crate::common::{Folder, SCENE};
use amberfield_scene::keys::SCENE as KEYS;

/// Names of the sections of which there may be several.
fn lists() -> Vec<&'static str> {
    let lists: Vec<&str> = KEYS.iter().filter(|key| key.form.is_list()).map(|key| key.name).collect();
    assert!(["materials", "pairs", "walls", "feeds", "outlets"].iter().all(|name| lists.contains(name)));
    lists
}

/// Good scene without any item of a list.
fn without(list: &str) -> String {
    let mut inside = false;
    let heading = format!("[[{list}]]");
    let kept = |line: &&str| {
        if line.starts_with('[') {
            inside = line.starts_with(&heading);
        }
        !inside
    };
    SCENE.lines().filter(kept).collect::<Vec<_>>().join("\n")
}

#[test]
fn an_empty_list_means_what_its_absence_means() {
    let folder = Folder::good();
    for list in lists() {
        let text = without(list);
        folder.write("scene.toml", format!("\n{text}"));
        let absent = folder.read(&[]);
        folder.write("scene.toml", format!("{list} = []\n{text}"));
        let empty = folder.read(&[]);
        assert_eq!(folder.read(&[&format!("{list}=[]")]).is_ok(), empty.is_ok(), "{list}");
        assert_eq!(empty, absent, "{list}");
        if let Err(error) = empty {
            assert!(list == "materials" && error.to_string().contains("missing key materials"), "{error}");
        }
    }
    folder.write("scene.toml", SCENE.replacen("\"steel\"", "\"steel\"\nmotion = []", 1));
    assert!(folder.read(&[]).unwrap().walls[0].motion.is_empty());
}

#[test]
fn a_list_that_is_none_is_told_how_to_be_written() {
    let folder = Folder::good();
    for list in lists() {
        let text = without(list);
        let scenes =
            [format!("{list} = {{}}\n{text}"), format!("{text}\n[{list}]\n"), format!("{list} = 3\n{text}")];
        for scene in scenes {
            folder.write("scene.toml", &scene);
            let said = folder.refusal(&[]);
            assert!(said.starts_with("scene.toml:") && said.contains(&format!("write [[{list}]]")), "{said}");
            assert_eq!(said.lines().count(), 1, "{said}");
        }
    }
    folder.write("scene.toml", SCENE.replacen("\"steel\"", "\"steel\"\nmotion = {}", 1));
    let said = folder.refusal(&[]);
    assert!(said.contains("walls[0].motion") && said.contains("write [[walls.motion]]"), "{said}");
}
