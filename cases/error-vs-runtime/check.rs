//! Smoke study of error against run time: the command fails when an error is above its promised or stated
//! bound.

use crate::support::Case;

#[test]
fn smoke_study_keeps_its_bounds() {
    let case = Case::new("error-vs-runtime");
    let page = case.study("smoke.toml", "smoke");
    for section in ["## What it says", "## The error model", "## What failed\n\nNothing."] {
        assert!(page.contains(section), "no {section:?} in\n{page}");
    }
    // The published hybrid method and the cut-off sum have errors of tens of per cent on the same grains.
    assert!(page.contains("kolehmainen") && page.contains("cut-off"), "{page}");
}
