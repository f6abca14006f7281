//! The smoke study: the command fails when an error is above what is promised or stated.

use crate::support::Case;

#[test]
fn smoke_study_keeps_its_bounds() {
    let case = Case::new("error-vs-runtime");
    let page = case.study("smoke.toml", "smoke");
    for section in ["## What it says", "## The error model", "## What failed\n\nNothing."] {
        assert!(page.contains(section), "no {section:?} in\n{page}");
    }
    // The published hybrid and the cut-off sum err by tens of per cent on the same grains.
    assert!(page.contains("kolehmainen") && page.contains("cut-off"), "{page}");
}
