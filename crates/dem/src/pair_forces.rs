//! Forces of touching grains on each other, chunk by chunk.

use crate::cells::{INDEX_BITS, INDEX_MASK};
use crate::chunks::{CHUNK, chunk_count, for_each_chunk, is_parallel};
use crate::contact_law::{Contact, respond};
use crate::grains::Grains;
use crate::material_pairs::PairTable;
use crate::neighbours::{ChunkList, Hit, Neighbours, Push};
use amberfield_core::Vector3;

/// What every chunk reads.
struct Scene<'a> {
    grains: &'a Grains,
    shifts: &'a [[f64; 3]; 32],
    table: &'a PairTable,
    step: f64,
}

/// Computes the forces and torques that chunks make on their own grains into `force` and `torque`
/// (overwritten), and on others into the outboxes. `step` [s] advances the springs.
pub(crate) fn pair_forces(
    grains: &Grains,
    neighbours: &mut Neighbours,
    table: &PairTable,
    periodic: bool,
    step: f64,
    force: &mut [Vector3<f64>],
    torque: &mut [Vector3<f64>],
) {
    let features = neighbours.features;
    let scene = Scene { grains, shifts: &neighbours.shifts, table, step };
    let lists = &mut neighbours.lists;
    macro_rules! run {
        ($f:literal, $r:literal, $d:literal, $p:literal) => {
            run::<$f, $r, $d, $p>(&scene, lists, force, torque)
        };
    }
    macro_rules! periodic {
        ($f:literal, $r:literal, $d:literal) => {
            if periodic { run!($f, $r, $d, true) } else { run!($f, $r, $d, false) }
        };
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

fn run<const FRICTION: bool, const ROLLING: bool, const DAMPING: bool, const PERIODIC: bool>(
    scene: &Scene<'_>,
    lists: &mut [ChunkList],
    force: &mut [Vector3<f64>],
    torque: &mut [Vector3<f64>],
) {
    let count = scene.grains.len();
    let (parallel, chunks) = (is_parallel(count), chunk_count(count));
    if FRICTION || ROLLING {
        for_each_chunk!(parallel, chunks, (lists / 1, force / CHUNK, torque / CHUNK), |k: usize,
                                                                                       (
            list,
            force,
            torque,
        ): (
            &mut [ChunkList],
            &mut [Vector3<f64>],
            &mut [Vector3<f64>]
        )| {
            chunk::<FRICTION, ROLLING, DAMPING, PERIODIC>(scene, k, &mut list[0], force, torque);
        });
    } else {
        for_each_chunk!(parallel, chunks, (lists / 1, force / CHUNK), |k: usize,
                                                                       (list, force): (
            &mut [ChunkList],
            &mut [Vector3<f64>]
        )| {
            chunk::<FRICTION, ROLLING, DAMPING, PERIODIC>(scene, k, &mut list[0], force, &mut []);
        });
    }
}

/// Distance test of every entry, branch-free: fills `hits` and returns their number.
#[inline(always)]
fn find_hits<const PERIODIC: bool>(scene: &Scene<'_>, first: usize, list: &mut ChunkList) -> usize {
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
            let hit = d.norm_squared() < reach * reach;
            hits[found] = Hit { entry: (offset + n) as u32, local: local as u32, slot };
            found += usize::from(hit);
            *touching &= hit;
            slot += u32::from(j.wrapping_sub(first) >= CHUNK);
        }
    }
    found
}

/// From the centre `a` to the centre `b`, or to its image.
#[inline(always)]
fn offset_of<const PERIODIC: bool>(scene: &Scene<'_>, a: &[f64; 4], b: &[f64; 4], code: u32) -> Vector3<f64> {
    let d = Vector3::new(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    if PERIODIC { d + Vector3::from(scene.shifts[(code >> INDEX_BITS) as usize]) } else { d }
}

/// Geometry and motion of the contact of i and j, and the distances of their centres from it.
#[inline(always)]
fn contact_of<const FRICTION: bool, const ROLLING: bool, const PERIODIC: bool>(
    scene: &Scene<'_>,
    i: usize,
    j: usize,
    code: u32,
) -> (Contact, f64, f64) {
    let grains = scene.grains;
    let (a, b) = (&grains.centre[i], &grains.centre[j]);
    let offset = offset_of::<PERIODIC>(scene, a, b, code);
    let distance = offset.norm();
    let overlap = a[3] + b[3] - distance;
    let (arm_i, arm_j) = (a[3] - 0.5 * overlap, b[3] - 0.5 * overlap);
    let (inverse_i, inverse_j) = (grains.inverse_mass[i], grains.inverse_mass[j]);
    let mut contact = Contact {
        overlap,
        normal: offset * (1.0 / distance),
        velocity: grains.velocity[i] - grains.velocity[j],
        spin: Vector3::zeros(),
        turning: Vector3::zeros(),
        radius: a[3] * b[3] / (a[3] + b[3]),
        inverse_mass: inverse_i + inverse_j,
        inverse_moment: 0.0,
    };
    if FRICTION {
        contact.spin = grains.angular[i] * arm_i + grains.angular[j] * arm_j;
    }
    if ROLLING {
        contact.turning = grains.angular[i] - grains.angular[j];
        contact.inverse_moment = inverse_i / (a[3] * a[3]) + inverse_j / (b[3] * b[3]);
    }
    (contact, arm_i, arm_j)
}

fn chunk<const FRICTION: bool, const ROLLING: bool, const DAMPING: bool, const PERIODIC: bool>(
    scene: &Scene<'_>,
    k: usize,
    list: &mut ChunkList,
    force: &mut [Vector3<f64>],
    torque: &mut [Vector3<f64>],
) {
    let first = k * CHUNK;
    force.fill(Vector3::zeros());
    torque.fill(Vector3::zeros());
    list.filled.fill(false);
    let found = find_hits::<PERIODIC>(scene, first, list);
    list.contacts = found;
    let grains = scene.grains;
    for n in 0..found {
        let Hit { entry, local, slot } = list.hits[n];
        let (entry, local) = (entry as usize, local as usize);
        let i = first + local;
        let code = list.partner[entry];
        let j = (code & INDEX_MASK) as usize;
        let (contact, arm_i, arm_j) = contact_of::<FRICTION, ROLLING, PERIODIC>(scene, i, j, code);
        let (mut spring, mut rolling) = ([0.0; 4], [0.0; 3]);
        if (FRICTION || ROLLING) && list.touching[entry] {
            if FRICTION {
                spring = list.spring[entry];
            }
            if ROLLING {
                rolling = list.rolling[entry];
            }
        }
        let pair = scene.table.get(grains.material[i], grains.material[j]);
        let response =
            respond::<FRICTION, ROLLING, DAMPING>(&contact, pair, scene.step, &mut spring, &mut rolling);
        list.touching[entry] = true;
        if FRICTION {
            list.spring[entry] = spring;
        }
        if ROLLING {
            list.rolling[entry] = rolling;
        }
        let mut push = Push { force: -response.force, torque: Vector3::zeros() };
        force[local] += response.force;
        if FRICTION || ROLLING {
            torque[local] += response.twist * arm_i + response.rolling;
            push.torque = response.twist * arm_j - response.rolling;
        }
        if let Some(force_j) = force.get_mut(j.wrapping_sub(first)) {
            *force_j += push.force;
            if FRICTION || ROLLING {
                torque[j - first] += push.torque;
            }
        } else {
            list.outbox[slot as usize] = push;
            list.filled[slot as usize] = true;
        }
    }
}
