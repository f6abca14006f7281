//! Case of grains that stick: pull-off, contact without load, sticking speed.

use crate::support::{Case, NumberTable};
use std::f64::consts::PI;

const RADIUS_M: f64 = 5e-5;
/// Work of adhesion of two equal solids: twice their surface energy.
const WORK: f64 = 0.1;
const STEP_S: f64 = 5e-9;
/// Y* of the scene's material with itself.
const YOUNG_PA: f64 = 1e7 / (2.0 * (1.0 - 0.25 * 0.25));
/// Bound on the pull-off force and the overlap without load.
const CLOSED_FORM: f64 = 1e-3;

/// Bodies that meet, and how.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    model: &'static str,
    on_wall: bool,
}

impl Meeting {
    const ALL: [Self; 4] = [
        Self { model: "jkr", on_wall: false },
        Self { model: "jkr", on_wall: true },
        Self { model: "dmt", on_wall: false },
        Self { model: "dmt", on_wall: true },
    ];

    /// R* [m].
    fn radius(self) -> f64 {
        if self.on_wall { RADIUS_M } else { 0.5 * RADIUS_M }
    }

    /// m* [kg].
    fn mass(self) -> f64 {
        let mass = 4.0 / 3.0 * PI * RADIUS_M.powi(3) * 2500.0;
        if self.on_wall { mass } else { 0.5 * mass }
    }

    /// Speed below which the bodies stay together, with the constant as Thornton and Ning print it [m/s].
    fn sticking_speed(self) -> f64 {
        let work = 7.09 * (WORK.powi(5) * self.radius().powi(4) / (YOUNG_PA * YOUNG_PA)).cbrt();
        (2.0 * work / self.mass()).sqrt()
    }

    fn case(self) -> Case {
        let case = Case::new("pull-off");
        case.replace("scene.toml", "\"jkr\"", &format!("{:?}", self.model));
        if self.on_wall {
            let wall = "[[walls]]\nplane = { point_m = [0, 0, 0], normal = [0, 0, 1] }\n\n[time]";
            case.replace("scene.toml", "[time]", wall);
            case.replace("scene.toml", "grains.csv", "grain.csv");
        }
        case
    }

    /// Speed of each grain [m/s] that makes the bodies meet at a speed [m/s].
    fn set_speed(self, case: &Case, speed: f64) {
        if self.on_wall {
            case.replace("grain.csv", "-0.3", &format!("-{speed}"));
        } else {
            case.replace("grains.csv", "0.2", &format!("{}", 0.5 * speed));
        }
    }

    /// Largest pull [N] between two rows of the history, from the kinetic energy ½ m* v².
    fn largest_pull(self, history: &NumberTable) -> f64 {
        let speeds: Vec<f64> =
            history.column("kinetic_J").iter().map(|energy| (2.0 * energy / self.mass()).sqrt()).collect();
        // The bodies leave after the moment of rest.
        let rest = (0..speeds.len()).min_by(|a, b| speeds[*a].total_cmp(&speeds[*b])).expect("rows");
        let slowed = speeds[rest..].windows(2).map(|pair| self.mass() * (pair[0] - pair[1]) / STEP_S);
        slowed.fold(0.0, f64::max)
    }
}

#[test]
fn bodies_are_parted_by_the_pull_off_force() {
    for meeting in Meeting::ALL {
        let factor = if meeting.model == "jkr" { 1.5 } else { 2.0 };
        let expected = factor * PI * WORK * meeting.radius();
        let case = meeting.case();
        // The pull of Derjaguin, Muller and Toporov is largest at the last moment of the contact.
        for key in ["step_s", "history_every_s"] {
            case.replace("scene.toml", &format!("{key} = 2e-8"), &format!("{key} = {STEP_S:e}"));
        }
        let found = meeting.largest_pull(&case.run(&[]).history());
        assert!((found / expected - 1.0).abs() < CLOSED_FORM, "{meeting:?}: {found:e} N, {expected:e} N");
    }
}

#[test]
fn wall_feels_the_pull_off_force() {
    let meeting = Meeting { model: "jkr", on_wall: true };
    let case = meeting.case();
    case.run(&[]);
    let forces = case.table("run/wall_forces.csv");
    let pull = forces.column("normal_z_N").iter().copied().fold(0.0, f64::max);
    let expected = 1.5 * PI * WORK * RADIUS_M;
    assert!((pull / expected - 1.0).abs() < CLOSED_FORM, "{pull:e} N, {expected:e} N");
}

#[test]
fn contact_without_load_has_the_area_of_johnson_kendall_and_roberts() {
    for meeting in Meeting::ALL {
        let case = meeting.case();
        meeting.set_speed(&case, 0.01);
        case.replace("scene.toml", "restitution = 1.0", "restitution = 0.1");
        case.replace("scene.toml", "end_s = 1.2e-4", "end_s = 1e-3");
        case.replace("scene.toml", "every_s = 1.2e-4", "every_s = 1e-3");
        let grains = case.run(&[]).last_particles();
        let z = grains.column("z_m");
        let overlap = if meeting.on_wall { RADIUS_M - z[0] } else { 2.0 * RADIUS_M - (z[0] - z[1]) };
        let radius = meeting.radius();
        // a₀² of the overlap: δ₀ = a₀²/(3R*) by JKR, a₀²/R* by DMT, whose contact is Hertz's.
        let (area, expected) = if meeting.model == "jkr" {
            let cube = 9.0 * PI * WORK * radius * radius / (2.0 * YOUNG_PA);
            (PI * 3.0 * radius * overlap, PI * cube.powf(2.0 / 3.0))
        } else {
            let cube = 3.0 * radius * 2.0 * PI * WORK * radius / (4.0 * YOUNG_PA);
            (PI * radius * overlap, PI * cube.powf(2.0 / 3.0))
        };
        assert!((area / expected - 1.0).abs() < CLOSED_FORM, "{meeting:?}: {area:e} m², {expected:e} m²");
    }
}

#[test]
fn bodies_stay_together_below_the_sticking_speed() {
    for on_wall in [false, true] {
        let meeting = Meeting { model: "jkr", on_wall };
        for (factor, stays) in [(0.98, true), (1.02, false)] {
            let case = meeting.case();
            meeting.set_speed(&case, factor * meeting.sticking_speed());
            let touching = case.run(&[]).history().column("contacts").to_vec();
            assert_eq!(touching.last() == Some(&1.0), stays, "{meeting:?} at {factor}");
            assert!(touching.contains(&1.0));
        }
    }
}
