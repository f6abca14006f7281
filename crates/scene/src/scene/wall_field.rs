//! Key `field` of `[[walls]]`: surfaces that are conductors of the field.

use super::description::ElectricFieldSettings;
use super::remesh::remeshed;
use crate::SceneError;
use crate::scene::OpenFoamSettings;
use crate::table::SceneTable;
use amberfield_core::{
    Boundary, Conductor, ConductorState, Domain, Method, MotionKind, TriangleMesh, Vector3, Wall,
    WallCharging, WallShape,
};

/// Sizes of facets that fit grains, over the radius of the smallest one.
const FITTING: [f64; 2] = [0.5, 7.0];
/// Size above which facets are divided, over that radius; beside edges some stay that are larger.
const DIVIDED: f64 = 5.5;
/// Most that a surface of divided facets bulges beyond those which grains touch, over that radius.
const BULGE: f64 = 0.25;
/// Facets in all up to which they are divided: up to here their error is measured.
const MOST_FACETS: usize = 3000;
/// Step of larger and larger sizes until facets are few enough.
const LARGER: f64 = 1.2;

/// Sections that decide whether a wall can bound the field.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub(super) solver: Option<&'a OpenFoamSettings>,
    pub(super) domain: Option<&'a Domain>,
    pub(super) field: Option<&'a ElectricFieldSettings>,
}

/// Reads what a wall is to the field; `None` where it does not bound it.
pub(super) fn read_wall_field(
    table: &SceneTable<'_>,
    wall: &Wall,
    around: Surroundings<'_>,
) -> Result<Option<Conductor>, SceneError> {
    let Some(state) = read_state(table)? else { return Ok(None) };
    let refuse = |problem: &str| Err(table.bad("field", problem));
    if table.has("patch") {
        return refuse(
            "a patch bounds the field by its boundary condition in the case's folder 0; remove field",
        );
    }
    let WallShape::Mesh(surface) = &wall.shape else {
        return refuse(
            "a plane has no facets to carry charge; make it a face of the domain, as boundary = { z_min = \
             \"grounded\" }, or give the wall an stl",
        );
    };
    if around.solver.is_some() {
        return refuse(
            "with [solver] the field ends at the patches of its mesh and nowhere else; make the surface a \
             patch and name it with patch = \"…\", or remove [solver]",
        );
    }
    let (Some(settings), Some(domain)) = (around.field, around.domain) else {
        return refuse("there is no field that the wall could bound; add [electric_field], or remove field");
    };
    check_settings(table, settings)?;
    if leaves(wall) {
        return refuse(
            "the wall has a motion, and the field knows walls at rest; remove the motion, let the surface \
             slide with surface_velocity_m_s, or set field = \"none\"",
        );
    }
    check_charging(table, wall.charging, state, settings)?;
    check_place(table, surface, domain)?;
    Ok(Some(Conductor { name: wall.name.clone(), surface: surface.clone(), state }))
}

/// Reads the potential or the charge; `None` for a wall that does not bound the field.
fn read_state(table: &SceneTable<'_>) -> Result<Option<ConductorState>, SceneError> {
    let Some(given) = table.table("field")? else {
        let words = [("grounded", Some(ConductorState::Potential(0.0))), ("none", None)];
        return Ok(table.word("field", &words)?.flatten());
    };
    match (given.number("potential_V")?, given.table("floating")?) {
        (Some(volts), None) => Ok(Some(ConductorState::Potential(volts))),
        (None, Some(floating)) => Ok(Some(ConductorState::Charge(floating.need_number("charge_C")?))),
        (Some(_), Some(_)) => {
            Err(given.bad("floating", "a conductor has a potential or a charge; give one of the two"))
        }
        (None, None) => Err(given.missing(
            "potential_V",
            "give { potential_V = 1000.0 } or { floating = { charge_C = 0.0 } }, or the word \"grounded\"",
        )),
    }
}

/// Refuses methods that have no conductors.
fn check_settings(table: &SceneTable<'_>, settings: &ElectricFieldSettings) -> Result<(), SceneError> {
    match settings.field.method {
        Method::P3m | Method::Direct => Ok(()),
        method => {
            let problem = format!(
                "method {method} knows no conductors but faces of the domain; set electric_field.method = \
                 \"p3m\", or field = \"none\""
            );
            Err(table.bad("field", problem))
        }
    }
}

/// Refuses conductors that would keep charge which the field does not see.
fn check_charging(
    table: &SceneTable<'_>,
    charging: WallCharging,
    state: ConductorState,
    settings: &ElectricFieldSettings,
) -> Result<(), SceneError> {
    let trades = settings.enable_collision_charge_transfer;
    match (charging, state) {
        (WallCharging::Insulating, _) => Err(table.bad(
            "charging",
            "an insulator keeps charge where grains leave it, but the wall's field makes it a conductor; set \
             charging = \"grounded\", or remove field",
        )),
        (WallCharging::Grounded, ConductorState::Charge(_)) if trades => Err(table.bad(
            "field",
            "the wall takes charge from grains, and a floating conductor would keep it, while its charge is \
             given; set charging = \"none\" for the wall, or give it a potential",
        )),
        _ => Ok(()),
    }
}

/// Refuses surfaces where the box has no place for them.
fn check_place(table: &SceneTable<'_>, surface: &TriangleMesh, domain: &Domain) -> Result<(), SceneError> {
    if domain.needs_neutrality() {
        return Err(table.bad(
            "field",
            "every face of the domain is insulating or periodic, so that there is no potential to compare \
             that of a conductor with; ground a face or make one open",
        ));
    }
    let is_closed = |boundary| boundary != Boundary::Open;
    let beyond = surface.bounds().and_then(|bounds| domain.farthest_beyond(&bounds, is_closed));
    if let Some((face, reach)) = beyond {
        let problem = format!(
            "the surface reaches {reach:.3e} m beyond the face {face}, which is not open: what lies there \
             has an image or a copy within the box; cut the surface at the face, or make the face open"
        );
        return Err(table.bad("field", problem));
    }
    let on_face = surface.triangles.iter().filter(|triangle| {
        is_in_conducting_face(domain, &triangle.map(|vertex| surface.vertices[vertex as usize]))
    });
    let (count, all) = (on_face.count(), surface.triangles.len());
    if count > 0 {
        let problem = format!(
            "{count} of the surface's {all} triangles lie in a face of the domain that is a conductor \
             already; cut them off, or remove field where there are no others"
        );
        return Err(table.bad("field", problem));
    }
    Ok(())
}

/// Whether a wall leaves its place.
pub(super) fn leaves(wall: &Wall) -> bool {
    wall.motion.iter().any(|motion| !matches!(motion.kind, MotionKind::Slide(_)))
}

/// Whether a wall lies on conducting faces of the domain.
pub(super) fn is_conducting_face(domain: &Domain, shape: &WallShape) -> bool {
    match shape {
        WallShape::Plane { point, normal } => is_on_conductor(domain, point, &-normal),
        WallShape::Mesh(mesh) => mesh.triangles.iter().all(|triangle| {
            is_in_conducting_face(domain, &triangle.map(|vertex| mesh.vertices[vertex as usize]))
        }),
    }
}

/// Whether a triangle lies in a conducting face of the domain.
fn is_in_conducting_face(domain: &Domain, corners: &[Vector3<f64>; 3]) -> bool {
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a)).normalize();
    [normal, -normal].iter().any(|out| corners.iter().all(|place| is_on_conductor(domain, place, out)))
}

fn is_on_conductor(domain: &Domain, place: &Vector3<f64>, out: &Vector3<f64>) -> bool {
    domain.face_under(place, out).is_some_and(Boundary::is_conductor)
}

/// Divides large facets, for grains of which the smallest has a radius [m]: to the size that fits them, or as
/// far as the number of facets allows. Grains touch the wall's own facets as before.
pub(super) fn fit_facets(conductors: &mut [Conductor], radius: f64, domain: Option<&Domain>) {
    let given: usize = conductors.iter().map(|conductor| conductor.surface.triangles.len()).sum();
    let most = MOST_FACETS.max(given);
    let is_beyond = |surface: &TriangleMesh| {
        let is_closed = |boundary| boundary != Boundary::Open;
        let bounds = surface.bounds();
        bounds.zip(domain).and_then(|(bounds, domain)| domain.farthest_beyond(&bounds, is_closed)).is_some()
    };
    let divided = |size: f64| {
        let mut left = most;
        let of = |conductor: &Conductor| {
            let surface = &conductor.surface;
            let bulging = remeshed(surface, size, BULGE * radius, left)?;
            // What touches a face that is not open must not bulge through it.
            let finer = if is_beyond(&bulging) { remeshed(surface, size, 0.0, left)? } else { bulging };
            left = left.checked_sub(finer.triangles.len())?;
            Some(finer)
        };
        conductors.iter().map(of).collect::<Option<Vec<_>>>()
    };
    let mut size = DIVIDED * radius;
    // Sizes of which even twice the triangles would not cover the surfaces need no trial.
    let squares: f64 =
        conductors.iter().flat_map(|conductor| conductor.surface.sizes()).map(|size| size * size).sum();
    while squares > 2.0 * most as f64 * size * size {
        size *= LARGER;
    }
    let finer = loop {
        if let Some(finer) = divided(size) {
            break finer;
        }
        size *= LARGER;
    };
    for (conductor, finer) in conductors.iter_mut().zip(finer) {
        conductor.surface = finer;
    }
}

/// Warnings about facets that do not fit grains of which the smallest has a radius [m].
pub(super) fn facets_that_misfit(conductor: &Conductor, radius: f64) -> Vec<String> {
    let sizes: Vec<f64> = conductor.surface.sizes().map(|size| size / radius).collect();
    let [least, most] = FITTING;
    let (name, all) = (&conductor.name, sizes.len());
    let small = sizes.iter().filter(|&&size| size < least).count();
    let large = sizes.iter().filter(|&&size| size > most).count();
    let mut found = Vec::new();
    if large > 0 {
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        found.push(format!(
            "{name}: {large} of the {all} facets that bound the field are larger than {most} radii of the \
             smallest grain, up to {largest:.1}, for facets are divided to {MOST_FACETS} in all: near them \
             the field is less exact where the surface bends or ends; mesh it finer where grains come near, \
             or leave out what is far from them"
        ));
    }
    if small > 0 {
        let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
        found.push(format!(
            "{name}: {small} of the {all} facets that bound the field are smaller than {least} radii of the \
             smallest grain, down to {smallest:.2}: memory and time grow with the square of their number; \
             mesh it coarser"
        ));
    }
    found
}
