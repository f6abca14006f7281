//! Commands `amberfield study` and `amberfield tune`.

use amberfield_tests::{CsvTable, Workbench};

const BOX: &str = "[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.01, 0.01, 0.01]\n[domain.boundary]\n\
    x = 'periodic'\ny = 'periodic'\nz = 'grounded'\n\
     [particles]\ngenerate = { material = 'glass', count = 300, radius_m = 3e-4, seed = 1, \
     charge_C = { bipolar = 1e-14 } }\n\
     [[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500.0\nyoung_Pa = 1e7\npoisson = 0.2\n\
     restitution = 0.9\nfriction = 0.3\n[electric_field]\n";

fn bench(methods: &str) -> Workbench {
    let bench = Workbench::new(BOX);
    let head = "name = 'small'\ntitle = 'Small'\npasses = 2\nleast_s = 0.0\n[[problems]]\nname = 'a box'\n\
        scene = 'scene.toml'\n";
    bench.write("study.toml", format!("{head}{methods}"));
    bench
}

#[test]
fn study_writes_rows_plots_and_a_page_that_say_the_same() {
    let bench = bench(
        "[[methods]]\nname = 'p3m'\nsweep = { key = 'electric_field.tolerance', values = [1e-1, 1e-2] }\n\
         [[methods]]\nname = 'cut-off'\nset = ['electric_field.method=cutoff']\n\
         sweep = { key = 'electric_field.field_cutoff_radius', values = [3], times = 6e-4 }\n\
         [[methods]]\nname = 'far too fine'\nset = ['electric_field.tolerance=7']\n",
    );
    let answer = bench.run(&["study", "study.toml", "--out", "out"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let page = bench.read("out/small.md");
    assert!(page.contains("far too fine") && page.contains("out of range"), "{page}");
    for file in ["small-0.svg", "small-0.png", "small-model.svg"] {
        assert!(bench.path("out/pictures").join(file).is_file(), "{file}");
    }
    let data = bench.names("out/data");
    assert!(data.len() == 1 && data[0].ends_with("-small.csv"), "{data:?}");
    let rows = bench.read(&format!("out/data/{}", data[0]));
    assert_eq!(rows.lines().count(), 1 + 4, "{rows}");
    assert!(rows.contains("amberfield field scene.toml --set 'electric_field.tolerance=0.1'"), "{rows}");
}

#[test]
fn whole_runs_are_compared_with_a_finer_one() {
    let walls = "[time]\nstep_s = 2e-6\nend_s = 4e-4\ngravity_m_s2 = [0, 0, -9.81]\n[output]\n\
        every_s = 4e-4\nformats = ['csv']\n";
    let bench = Workbench::new(&format!("{BOX}{walls}"));
    let study = "name = 'runs'\ntitle = 'Runs'\n[[motions]]\nname = 'falling'\nscene = 'scene.toml'\n\
        reference = ['electric_field.tolerance=1e-5', 'electric_field.coupling_interval=1', \
        'electric_field.tuning=model']\n\
         replicas = { key = 'particles.generate.seed', values = [2, 3] }\n[[motions.variants]]\n\
         name = 'tolerance'\nsweep = { key = 'electric_field.tolerance', values = [1e-2, 1e-5] }\n";
    bench.write("study.toml", study);
    let answer = bench.run(&["study", "study.toml", "--out", "out"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let data = bench.names("out/data");
    assert!(data.len() == 1 && data[0].ends_with("-runs-motions.csv"), "{data:?}");
    let table = CsvTable::parse(&bench.read(&format!("out/data/{}", data[0])));
    let error = table.numbers("position_error");
    assert!(error[0] > 1e-12 && error[0] < 1e-6, "{error:?}");
    assert_eq!(error[1], 0.0, "the reference's own settings");
    assert!(bench.read("out/runs.md").contains("## falling"));
}

#[test]
fn study_fails_where_an_error_is_above_its_bound() {
    let bench = bench(
        "[[methods]]\nname = 'cut-off'\nset = ['electric_field.method=cutoff', \
         'electric_field.field_cutoff_radius=1e-3']\nmost_error = 1e-3\n",
    );
    let answer = bench.run(&["study", "study.toml", "--out", "out"]);
    assert_eq!(answer.code, Some(4), "{}", answer.stderr);
    assert!(answer.stderr.contains("above their bound"), "{}", answer.stderr);
    assert!(bench.read("out/small.md").contains("above 1e-3"));
}

#[test]
fn bad_studies_are_refused_by_name() {
    let bench = bench("[[methods]]\nname = 'p3m'\nsweeps = 1\n");
    let answer = bench.run(&["study", "study.toml", "--out", "out"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.stderr.contains("study.toml") && answer.stderr.contains("sweeps"), "{}", answer.stderr);
    let answer = bench.run(&["study", "none.toml"]);
    assert!(answer.code == Some(2) && answer.stderr.contains("none.toml"), "{}", answer.stderr);
}

#[test]
fn tune_lists_candidates_and_checks_its_choice() {
    let bench = Workbench::new(BOX);
    let answer = bench.run(&["tune", "scene.toml", "--tolerance", "1e-3", "--out", "tune.csv"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    assert!(answer.stdout.contains("against the direct sum"), "{}", answer.stdout);
    let table = bench.read("tune.csv");
    assert!(table.lines().last().expect("a line").starts_with("true,"), "{table}");
    let seconds = CsvTable::parse(&table).numbers("seconds");
    assert!(seconds.len() > 2 && seconds.iter().all(|seconds| *seconds > 0.0), "{table}");
}

#[test]
fn tune_ends_with_an_answer_whatever_the_charges() {
    let bench = Workbench::new(BOX);
    let tune = |set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        bench.run(&[&["tune", "scene.toml", "--out", "tune.csv"], &set[..]].concat())
    };
    let corner = "particles.generate.region={box={min_m=[0,0,0],max_m=[1e-3,1e-3,1e-3]}}";
    for good in [
        &["particles.generate.count=1"][..],
        &["particles.generate.charge_C={constant=0.0}"],
        &[corner, "particles.generate.radius_m=2e-5"],
        &["domain.boundary={x='insulating',y='insulating',z='insulating'}"],
        &["domain.boundary={x='open',y='open',z='open'}"],
    ] {
        let answer = tune(good);
        assert_eq!(answer.code, Some(0), "{good:?}: {}", answer.stderr);
    }
    for (bad, reason) in [
        (&["electric_field.method=direct"][..], "no parameters to choose"),
        (&["particles.generate.charge_C={constant=1e-14}", "domain.boundary.z=insulating"], "net charge"),
        (&["electric_field.grid.cells=[2, 2, 2]", "electric_field.field_cutoff_radius=1e-3"], "tolerance"),
        (&["electric_field.tolerance=nan"], "tolerance"),
    ] {
        let answer = tune(bad);
        assert!(matches!(answer.code, Some(2 | 4)), "{bad:?}: {:?} {}", answer.code, answer.stderr);
        assert!(answer.stderr.contains(reason), "{bad:?}: {}", answer.stderr);
    }
}
