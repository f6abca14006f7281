//! Forces of touching grains on each other, chunk by chunk.

use crate::contacts::batch::{BATCH, Batch};
use crate::contacts::cells::{INDEX_BITS, INDEX_MASK};
use crate::contacts::material_pairs::PairTable;
use crate::contacts::memory::{Follow, Spring};
use crate::contacts::neighbours::{ChunkList, Hit, Neighbours};
use crate::contacts::normal::{Dmt, Hertz, Jkr, NormalLaw};
use crate::motion::chunks::{CHUNK, ChunkLoads, Loads, NO_PUSH, Push, for_each_load};
use crate::motion::grains::Grains;
use amberfield_core::{Cohesion, RollingModel, Vector3};
use amberfield_laws::hertz_mindlin;

/// Data that every chunk reads.
struct Scene<'a> {
    grains: &'a Grains,
    shifts: &'a [[f64; 3]; 32],
    table: &'a PairTable,
    rolling_model: RollingModel,
    step: f64,
    follow: Option<Follow>,
}

/// Computes what chunks do to their own grains into `loads` (overwritten), and to others into the outboxes.
/// `step` [s] advances the springs. Contact areas are followed if anyone wants to know them.
pub(crate) fn pair_forces(
    grains: &Grains,
    neighbours: &mut Neighbours,
    table: &PairTable,
    step: f64,
    follow: Option<Follow>,
    loads: &mut Loads,
) {
    let features = neighbours.features;
    let rolling_model = features.rolling_model;
    let scene = Scene { grains, shifts: &neighbours.shifts, table, rolling_model, step, follow };
    let periodic = neighbours.shifts.iter().flatten().any(|shift| *shift != 0.0);
    let lists = &mut neighbours.lists[..];
    macro_rules! run {
        ($law:ty, $f:literal, $r:literal, $d:literal, $p:literal) => {
            for_each_load(lists, loads, |k, list, loads| {
                chunk::<$law, $f, $r, $d, $p>(&scene, k, list, loads)
            })
        };
    }
    macro_rules! periodic {
        ($f:literal, $r:literal, $d:literal) => {
            if periodic { run!(Hertz, $f, $r, $d, true) } else { run!(Hertz, $f, $r, $d, false) }
        };
    }
    // Cohesive contacts have all terms: fewer loops to build, and they are not the fast case.
    match (features.cohesion, features.rolling) {
        (Cohesion::None, _) => {}
        (Cohesion::Dmt, false) => return run!(Dmt, true, false, true, true),
        (Cohesion::Dmt, true) => return run!(Dmt, true, true, true, true),
        (Cohesion::Jkr, false) => return run!(Jkr, true, false, true, true),
        (Cohesion::Jkr, true) => return run!(Jkr, true, true, true, true),
    }
    match (features.friction, features.rolling, features.damping) {
        (false, false, false) => periodic!(false, false, false),
        (false, false, true) => periodic!(false, false, true),
        (false, true, false) => periodic!(false, true, false),
        (false, true, true) => periodic!(false, true, true),
        (true, false, false) => periodic!(true, false, false),
        (true, false, true) => periodic!(true, false, true),
        (true, true, false) => periodic!(true, true, false),
        (true, true, true) => periodic!(true, true, true),
    }
}

/// Distance test of every entry, branch-free where contacts end at zero overlap: fills `hits` and
/// returns their number.
#[inline(always)]
fn find_hits<L: NormalLaw, const PERIODIC: bool>(
    scene: &Scene<'_>,
    first: usize,
    list: &mut ChunkList,
) -> usize {
    let centre = &scene.grains.centre[..];
    let ChunkList { start, partner, touching, hits, .. } = list;
    let length = start.len() - 1;
    let (mut found, mut slot) = (0_usize, 0_u32);
    for local in 0..length {
        let a = centre[first + local];
        let range = start[local] as usize..start[local + 1] as usize;
        let offset = range.start;
        for (n, (&code, touching)) in partner[range.clone()].iter().zip(&mut touching[range]).enumerate() {
            let j = (code & INDEX_MASK) as usize;
            let d = offset_of::<PERIODIC>(scene, &a, &centre[j], code);
            let reach = a[3] + centre[j][3];
            let mut hit = d.norm_squared() < reach * reach;
            if L::STRETCHES && *touching && !hit {
                let material = &scene.grains.material;
                let radius = hertz_mindlin::effective(a[3], centre[j][3]);
                let reach = reach + scene.table.stretch(material[first + local], material[j], radius);
                hit = d.norm_squared() < reach * reach;
            }
            hits[found] = Hit { entry: (offset + n) as u32, local: local as u32, slot };
            found += usize::from(hit);
            *touching &= hit;
            slot += u32::from(j.wrapping_sub(first) >= CHUNK);
        }
    }
    found
}

/// Offset from the centre `a` to the centre `b`, or to its image [m].
#[inline(always)]
fn offset_of<const PERIODIC: bool>(scene: &Scene<'_>, a: &[f64; 4], b: &[f64; 4], code: u32) -> Vector3<f64> {
    let d = Vector3::new(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    if PERIODIC { d + Vector3::from(scene.shifts[(code >> INDEX_BITS) as usize]) } else { d }
}

/// Reads the grains and the history of a touching entry into a lane of a batch.
#[inline(always)]
fn read<L, const FRICTION: bool, const ROLLING: bool, const DAMPING: bool, const PERIODIC: bool>(
    scene: &Scene<'_>,
    list: &ChunkList,
    entry: usize,
    i: usize,
    batch: &mut Batch,
    lane: usize,
) where
    L: NormalLaw,
{
    let grains = scene.grains;
    let code = list.partner[entry];
    let j = (code & INDEX_MASK) as usize;
    let (a, b) = (&grains.centre[i], &grains.centre[j]);
    batch.offset.set(lane, offset_of::<PERIODIC>(scene, a, b, code));
    batch.velocity.set(lane, grains.velocity[i] - grains.velocity[j]);
    (batch.radius[0][lane], batch.radius[1][lane]) = (a[3], b[3]);
    (batch.inverse_mass[0][lane], batch.inverse_mass[1][lane]) =
        (grains.inverse_mass[i], grains.inverse_mass[j]);
    if scene.table.is_mixed() {
        batch.pair.set(lane, scene.table.get(grains.material[i], grains.material[j]));
    }
    if L::COHESIVE {
        batch.work[lane] = scene.table.work(grains.material[i], grains.material[j]);
    }
    if DAMPING || ROLLING {
        batch.forecast.set(lane, grains.forecast[i] - grains.forecast[j]);
        batch.slowing[lane] = grains.slowing[i] + grains.slowing[j];
    }
    if FRICTION || ROLLING {
        batch.angular[0].set(lane, grains.angular[i]);
        batch.angular[1].set(lane, grains.angular[j]);
    }
    let touching = list.touching[entry];
    if FRICTION {
        let Spring { force, contact_radius } = if touching { list.spring[entry] } else { Spring::default() };
        batch.spring.set(lane, force.into());
        batch.contact_radius[lane] = contact_radius;
    }
    if ROLLING {
        let spring = if touching { list.rolling[entry] } else { [0.0; 3] };
        batch.rolling.set(lane, spring.into());
    }
}

fn chunk<L, const FRICTION: bool, const ROLLING: bool, const DAMPING: bool, const PERIODIC: bool>(
    scene: &Scene<'_>,
    k: usize,
    list: &mut ChunkList,
    mut loads: ChunkLoads<'_>,
) where
    L: NormalLaw,
{
    let first = k * CHUNK;
    loads.force.fill(Vector3::zeros());
    loads.torque.fill(Vector3::zeros());
    loads.slowing.fill(0.0);
    list.filled.fill(false);
    let found = find_hits::<L, PERIODIC>(scene, first, list);
    (list.contacts, list.deepest) = (found, 0.0);
    list.met.clear();
    let mut batch = Batch::new(*scene.table.get(0, 0));
    for start in (0..found).step_by(BATCH) {
        let size = BATCH.min(found - start);
        for lane in 0..size {
            let Hit { entry, local, .. } = list.hits[start + lane];
            let i = first + local as usize;
            read::<L, FRICTION, ROLLING, DAMPING, PERIODIC>(scene, list, entry as usize, i, &mut batch, lane);
        }
        batch.respond::<L, FRICTION, ROLLING, DAMPING>(scene.rolling_model, scene.step);
        if let Some(follow) = scene.follow {
            for lane in 0..size {
                list.follow_area(list.hits[start + lane].entry, batch.area::<FRICTION>(lane), follow);
            }
        }
        for lane in 0..size {
            write::<FRICTION, ROLLING, DAMPING>(list, start + lane, first, &batch, lane, &mut loads);
        }
    }
}

/// Adds up what a lane's contact does, and keeps its history.
#[inline(always)]
fn write<const FRICTION: bool, const ROLLING: bool, const DAMPING: bool>(
    list: &mut ChunkList,
    hit: usize,
    first: usize,
    batch: &Batch,
    lane: usize,
    loads: &mut ChunkLoads<'_>,
) {
    let Hit { entry, local, slot } = list.hits[hit];
    let (entry, local) = (entry as usize, local as usize);
    let j = (list.partner[entry] & INDEX_MASK) as usize;
    if !list.touching[entry] {
        list.met.push(list.hits[hit]);
    }
    list.touching[entry] = true;
    list.deepest = list.deepest.max(batch.depth[lane]);
    if FRICTION {
        let force = batch.spring.get(lane).into();
        list.spring[entry] = Spring { force, contact_radius: batch.contact_radius[lane] };
    }
    if ROLLING {
        list.rolling[entry] = batch.rolling.get(lane).into();
    }
    let on_i = batch.force.get(lane);
    let mut push = Push { force: -on_i, ..NO_PUSH };
    loads.force[local] += on_i;
    if FRICTION || ROLLING {
        loads.torque[local] += batch.torque[0].get(lane);
        push.torque = batch.torque[1].get(lane);
    }
    if DAMPING || ROLLING {
        loads.slowing[local] += batch.damping[lane] * batch.inverse_mass[0][lane];
        push.slowing = batch.damping[lane] * batch.inverse_mass[1][lane];
    }
    let local_j = j.wrapping_sub(first);
    if let Some(force_j) = loads.force.get_mut(local_j) {
        *force_j += push.force;
        if FRICTION || ROLLING {
            loads.torque[local_j] += push.torque;
        }
        if DAMPING || ROLLING {
            loads.slowing[local_j] += push.slowing;
        }
    } else {
        list.outbox[slot as usize] = push;
        list.filled[slot as usize] = true;
    }
}
