//! Outlets: places at which grains leave.

use crate::error::{DemError, SceneKey};
use crate::setup::Setup;
use amberfield_core::{Domain, Outlet, OutletRegion, Side, Vector3, Volume};

/// The outlets of a scene.
#[derive(Debug)]
pub(crate) struct Outlets {
    /// Number and volume of each outlet that has one, with the box around it.
    volumes: Vec<(u16, Volume, [Vector3<f64>; 2])>,
    /// Numbers of the outlets at faces of the box, by axis and side.
    faces: [[Option<u16>; 2]; 3],
}

impl Outlets {
    /// Takes outlets; `None` without any.
    pub(crate) fn new(list: &[Outlet]) -> Option<Self> {
        let mut all = Self { volumes: Vec::new(), faces: [[None; 2]; 3] };
        for (number, outlet) in (0..).zip(list) {
            match &outlet.region {
                OutletRegion::Volume(volume) => {
                    all.volumes.push((number, volume.clone(), volume.bounds()));
                }
                OutletRegion::Face(axis, side) => all.faces[axis.index()][*side as usize] = Some(number),
            }
        }
        (!list.is_empty()).then_some(all)
    }

    /// Outlet at a face of the box.
    pub(crate) fn at_face(&self, axis: usize, side: Side) -> Option<u16> {
        self.faces[axis][side as usize]
    }

    /// Outlet in whose volume a place [m] is; the first of several.
    pub(crate) fn holding(&self, domain: &Domain, place: Vector3<f64>) -> Option<u16> {
        if self.volumes.is_empty() {
            return None;
        }
        let place = domain.wrap(place);
        let holds = |(_, volume, [low, high]): &&(u16, Volume, [Vector3<f64>; 2])| {
            (0..3).all(|a| place[a] >= low[a] && place[a] <= high[a]) && volume.holds(&place, 0.0)
        };
        self.volumes.iter().find(holds).map(|(number, ..)| *number)
    }
}

/// Checks the outlets of a set-up.
pub(crate) fn check(setup: &Setup) -> Result<(), DemError> {
    let domain = &setup.domain;
    for (number, outlet) in setup.outlets.iter().enumerate() {
        let bad = |key: &'static [&'static str], problem: String| {
            let key = SceneKey { section: "outlets", number, names: key };
            Err(key.refuse(format!("outlet \"{}\": {problem}", outlet.name)))
        };
        match &outlet.region {
            OutletRegion::Volume(volume) => {
                if let Some(overrun) = domain.overrun(&volume.bounds()) {
                    let problem = format!("its region {overrun}; shrink the region or enlarge the domain");
                    return bad(&["region"], problem);
                }
            }
            OutletRegion::Face(axis, side) => {
                let name = axis.face_name(*side);
                if domain.is_periodic(*axis) {
                    let problem = format!(
                        "no grain leaves through its face {name}, since {axis} is periodic; name another \
                         face or give a region"
                    );
                    return bad(&["face"], problem);
                }
                let is_same = |other: &&Outlet| other.region == outlet.region;
                if let Some(other) = setup.outlets[..number].iter().find(is_same) {
                    let problem = format!("outlet \"{}\" has the face {name} too; leave one out", other.name);
                    return bad(&["face"], problem);
                }
            }
        }
    }
    Ok(())
}
