//! Parts of a case for several ranks: whose dictionary they are cut by.

use super::{difference, good};
use amberfield_tests::foam_case::{brick, write_case, write_file};
use amberfield_tests::{Answer, CsvTable, Workbench};

const SCENE: &str = "[particles]\nfile = 'grains.csv'\n[electric_field]\ntuning = 'model'\n\
    [solver]\nopenfoam_case = 'foam'\ntimeout_s = 60.0\n";
const GRAINS: &str = "id,x_m,y_m,z_m,radius_m,charge_C\n1,2e-3,1.1e-3,2.1e-3,0,1e-12\n\
    2,7e-3,2.9e-3,1.3e-3,0,-1e-12\n";
const DICTIONARY: &str = "system/decomposeParDict";
/// Difference of the same field on other ranks, over its RMS: each has a grid of its own for the density of
/// the clouds, good to 1e-4.
const OTHER_RANKS: f64 = 1e-4;

fn bench() -> Workbench {
    let bench = Workbench::new(SCENE);
    let brick = brick([9.0, 4.0, 4.0], [9, 4, 4], &[("wall", "type fixedValue; value uniform 0;"); 6]);
    write_case(&bench, &brick.mesh, &brick.conditions, "Gauss linear");
    bench.write("grains.csv", GRAINS);
    bench
}

fn field(bench: &Workbench, ranks: u32) -> Answer {
    bench.run(&["field", "scene.toml", "--out", "out.csv", "--set", &format!("solver.ranks={ranks}")])
}

fn e(bench: &Workbench) -> Vec<f64> {
    let table = CsvTable::parse(&bench.read("out.csv"));
    ["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"].iter().flat_map(|name| table.numbers(name)).collect()
}

/// Parts of the case, by number.
fn parts(bench: &Workbench) -> usize {
    bench.names("out-solver").iter().filter(|name| name.starts_with("processor")).count()
}

#[test]
fn case_is_cut_by_its_own_dictionary_where_that_works_else_by_ours_and_the_log_says_so() {
    let bench = bench();
    good(&field(&bench, 1));
    let one = e(&bench);
    let asks = "system/decomposeParDict of";
    // Each cut follows the one before, and so other numbers of parts must go.
    for (text, ranks, said) in [
        ("", 3, None),
        ("numberOfSubdomains 2; method simple; simpleCoeffs { n (1 2 1); }", 2, None),
        (
            "numberOfSubdomains 2; method simple; simpleCoeffs { n (1 2 1); }",
            3,
            Some("asks for 2 parts, and the scene for 3 ranks; the case is cut into 3 x 1 x 1 parts"),
        ),
        ("#include \"number\"\nnumberOfSubdomains $number; method scotch;", 4, Some("asks for 5 parts")),
        ("numberOfSubdomains 4; method scotch;", 4, Some("a method that this OpenFOAM lacks")),
        ("numberOfSubdomains 3; method simple; simpleCoeffs { n (1 1 3); }", 3, None),
        ("numberOfSubdomains 2; method ptscotch;", 2, Some("a method that this OpenFOAM lacks")),
    ] {
        if !text.is_empty() {
            bench.write("foam/system/number", "number 5;\n");
            write_file(&bench, DICTIONARY, "dictionary", text);
        }
        let before = std::fs::read(bench.path("foam").join(DICTIONARY)).ok();
        let answer = field(&bench, ranks);
        good(&answer);
        let line = answer.stderr.lines().find(|line| line.contains(asks));
        assert_eq!(line.is_some(), said.is_some(), "{text}, {ranks} ranks: {}", answer.stderr);
        assert!(
            line.unwrap_or_default().contains(said.unwrap_or_default()),
            "{text}, {ranks} ranks: {}",
            answer.stderr
        );
        let after = std::fs::read(bench.path("foam").join(DICTIONARY)).ok();
        assert_eq!(after, before, "{text}: the user's file stays as it is");
        assert_eq!(parts(&bench), ranks as usize);
        assert!(difference(&e(&bench), &one) < OTHER_RANKS, "{text}, {ranks} ranks");
    }
    // What is cut is not cut again.
    let again = field(&bench, 2);
    good(&again);
    assert!(!again.stderr.contains(asks), "{}", again.stderr);
}

#[test]
fn dictionary_with_a_mistake_is_an_error_that_names_it() {
    let bench = bench();
    write_file(
        &bench,
        DICTIONARY,
        "dictionary",
        "numberOfSubdomains 2; method simple; simpleCoeffs { n (2 2 1); }",
    );
    let answer = field(&bench, 2);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("decomposePar failed"), "{}", answer.stderr);
    assert_eq!(parts(&bench), 0);
}
