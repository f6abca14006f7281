//! First steps of a newcomer: scenes to start from, and keys in the terminal.

use amberfield_tests::Workbench;

#[test]
fn scenes_to_start_from_are_listed_written_and_run() {
    let bench = Workbench::new("");
    let list = bench.run(&["new"]);
    for (name, steps) in [("bed", "30"), ("separator", "30"), ("chute", "30"), ("fluidised-bed", "")] {
        assert!(list.stdout.contains(name), "{}", list.stdout);
        assert_eq!(bench.run(&["new", name]).code, Some(0));
        let scene = format!("{name}/scene.toml");
        // The flow needs its program, which tests of OpenFOAM have.
        let answer = match steps {
            "" => bench.run(&["keys", "solver"]),
            steps => bench.run(&["run", &scene, "--out", &format!("{name}-run"), "--steps", steps]),
        };
        assert_eq!(answer.code, Some(0), "{name}: {}", answer.stderr);
        let again = bench.run(&["new", name]);
        assert!(again.code == Some(2) && again.stderr.contains("--out"), "{}", again.stderr);
    }
    let unknown = bench.run(&["new", "hopper"]);
    assert!(unknown.code == Some(2) && unknown.stderr.contains("separator"), "{}", unknown.stderr);
}

#[test]
fn keys_are_shown_in_the_terminal() {
    let bench = Workbench::new("");
    assert!(bench.run(&["keys"]).stdout.lines().count() > 90);
    let one = bench.run(&["keys", "walls[0].plane"]);
    assert!(one.code == Some(0) && one.stdout.contains("point_m"), "{}", one.stdout);
    let guess = bench.run(&["keys", "diameter"]);
    assert!(guess.code == Some(2) && guess.stderr.contains("half the diameter"), "{}", guess.stderr);
}
