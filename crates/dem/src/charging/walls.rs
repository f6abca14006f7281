//! Trade of a grain with a wall.

use super::around::{Toucher, WALL};
use super::contact_field::Mirror;
use super::spots::Contact;
use super::{Charging, LAG_SEEN, Traders};
use crate::contacts::neighbours::Neighbours;
use crate::contacts::walls::{ContactWalls, Touch, Touching};
use amberfield_core::{Vector3, WallCharging};
use amberfield_laws::charge_transfer::{ChargedSphere, with_grounded_wall, with_insulating_wall};

impl Charging {
    /// Moves what is due between grains and walls. `charge` is by the set-up's order [C].
    pub(super) fn trade_walls(
        &mut self,
        traders: Traders<'_>,
        neighbours: &Neighbours,
        walls: &mut ContactWalls,
        charge: &mut [f64],
    ) {
        let mut grown = std::mem::take(&mut self.touches);
        grown.clear();
        grown.extend(walls.touches(traders.grains).filter(|touching| touching.growth.due() > 0.0));
        if self.backwards {
            grown.reverse();
        }
        if self.lag > LAG_SEEN && !grown.is_empty() {
            self.around.build(traders.grains, neighbours);
        }
        self.traded_at_walls.clear();
        let mut largest = 0.0_f64;
        for Touching { slot, touch, growth } in &grown {
            walls.growth_mut(*slot).settle();
            largest = largest.max(self.trade_wall(traders, touch, growth.due(), charge));
        }
        self.lag += largest;
        self.touches = grown;
    }

    /// Moves the charge that a growth of the area [m²] moves at one contact; returns αΔA, by how much the
    /// contact relaxed.
    fn trade_wall(&mut self, traders: Traders<'_>, touch: &Touch, growth: f64, charge: &mut [f64]) -> f64 {
        let grains = traders.grains;
        let Some(a) = traders.member(touch.grain) else { return 0.0 };
        let materials = self.table.get(grains.material[touch.grain], touch.material);
        let contact = Contact::of(traders, touch);
        let number = self.spots.at(traders.domain, &contact);
        let foreseen = self.foreseen_at_wall(traders, touch);
        let mut field = foreseen.unwrap_or_else(|| self.unforeseen_at_wall(traders, touch, charge));
        if self.lag > LAG_SEEN {
            let wall_itself = Toucher { grain: WALL, offset: Vector3::zeros() };
            let charges = |grain: usize| charge[grains.original[grain].index()];
            let gained =
                self.gained_beside(grains, touch.grain, &wall_itself, touch.normal, touch.distance, charges);
            // A grounded wall mirrors the charges around, and doubles their normal field at its surface.
            field += gained * if touch.charging == WallCharging::Grounded { 2.0 } else { 1.0 };
        }
        let grain = ChargedSphere { charge: charge[a], radius: grains.centre[touch.grain][3] };
        let (permittivity, work) = (self.permittivity, materials.work);
        let drive = match touch.charging {
            WallCharging::Insulating => {
                let kept = self.spots.felt(traders.domain, &contact, number, self.coulomb);
                with_insulating_wall(permittivity, work, grain, kept, field)
            }
            _ => with_grounded_wall(permittivity, work, grain, field),
        };
        let growth = growth * materials.area_factor;
        let moved = self.allowed(drive, work, drive.transfer(growth));
        // Positive is from the grain to the wall.
        charge[a] -= moved;
        self.ledger.gained[usize::from(grains.material[touch.grain])] -= moved;
        self.spots.leave(traders.domain, number, &contact, moved);
        self.ledger.walls[touch.wall as usize] += moved;
        self.ledger.moved += moved.abs();
        self.traded_at_walls.push(touch.grain as u32);
        drive.decay * growth
    }
}

impl Contact {
    /// Contact of a grain with a wall.
    pub(super) fn of(traders: Traders<'_>, touch: &Touch) -> Self {
        let Traders { domain, grains, .. } = traders;
        Self {
            wall: touch.wall,
            keeps: touch.charging == WallCharging::Insulating,
            bounds_field: Mirror::image(domain, grains, touch) != 0.0,
            place: touch.place(grains),
            inward: -touch.normal,
            radius: grains.centre[touch.grain][3],
        }
    }
}
