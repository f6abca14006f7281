//! Checks of all cases, each run by the binary at smoke size and compared with the number in its README.
//! `AMBERFIELD_CASES=full cargo test -p amberfield-cli --test cases` runs them at full size.

mod support;

#[path = "belt/check.rs"]
mod belt;
#[path = "capacitor/check.rs"]
mod capacitor;
#[path = "centrifuge/check.rs"]
mod centrifuge;
#[path = "charged-ball/check.rs"]
mod charged_ball;
#[path = "charging-gas/check.rs"]
mod charging_gas;
#[path = "charging-on-a-wall/check.rs"]
mod charging_on_a_wall;
#[path = "coupled-settling-bed/check.rs"]
mod coupled_settling_bed;
#[path = "electrode-channel/check.rs"]
mod electrode_channel;
#[path = "error-vs-runtime/check.rs"]
mod error_vs_runtime;
#[path = "extremes/check.rs"]
mod extremes;
#[path = "falling-in-air/check.rs"]
mod falling_in_air;
#[path = "faraday-cup/check.rs"]
mod faraday_cup;
#[path = "fluidised-charged-bed/check.rs"]
mod fluidised_charged_bed;
#[path = "grounded-plane/check.rs"]
mod grounded_plane;
#[path = "grounded-sphere/check.rs"]
mod grounded_sphere;
#[path = "heap/check.rs"]
mod heap;
#[path = "hopper/check.rs"]
mod hopper;
#[path = "impact/check.rs"]
mod impact;
#[path = "madelung/check.rs"]
mod madelung;
#[path = "particle-impacts/check.rs"]
mod particle_impacts;
#[path = "pull-off/check.rs"]
mod pull_off;
#[path = "sensing-ring/check.rs"]
mod sensing_ring;
#[path = "separator/check.rs"]
mod separator;
#[path = "settling-charged-bed/check.rs"]
mod settling_charged_bed;
#[path = "shaken-bed/check.rs"]
mod shaken_bed;
#[path = "shaker/check.rs"]
mod shaker;
#[path = "stiffness-collapse/check.rs"]
mod stiffness_collapse;
#[path = "tribo-separator/check.rs"]
mod tribo_separator;
#[path = "two-grains/check.rs"]
mod two_grains;
#[path = "two-materials/check.rs"]
mod two_materials;
