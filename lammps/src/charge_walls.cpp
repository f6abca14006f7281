// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

// Charge that moves between grains and walls.

#include "fix_amberfield_charge.h"

#include "fix_amberfield_field.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "region.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;

namespace {

// A wall nearer to a face than this, over the length of the box, is the face.
constexpr double ON_FACE = 1e-6;

double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}    // namespace

void FixAmberfieldCharge::trade_walls()
{
    for (size_t wall = 0; wall < regions_.size(); ++wall) {
        Region *region = regions_[wall];
        region->prematch();
        if (region->dynamic_check()) {
            region->set_velocity();
            if (kept_) kept_->follow(wall, region);
        }
        for (int i = 0; i < atom->nlocal; ++i) {
            if (!(atom->mask[i] & groupbit)) continue;
            const double *x = atom->x[i];
            const int contacts = region->surface(x[0], x[1], x[2], atom->radius[i]);
            for (int k = 0; k < contacts; ++k) {
                const double moved = trade_wall(i, wall, region, k);
                of_walls_[wall] += moved;
                moved_ += std::abs(moved);
            }
        }
    }
}

// Moves charge at one contact with a wall; returns what the wall takes.
double FixAmberfieldCharge::trade_wall(int i, int number_of_wall, Region *region, int number)
{
    const amberfield::ChargingWall &wall = words_.walls[number_of_wall];
    const Region::Contact &touch = region->contact[number];
    const double distance = touch.r, radius = atom->radius[i];
    if (!(distance > 0.0) || distance >= radius) return 0.0;
    const double normal[3] = {-touch.delx / distance, -touch.dely / distance, -touch.delz / distance};
    double of_wall[3] = {0.0, 0.0, 0.0};
    if (region->dynamic_check()) region->velocity_contact(of_wall, atom->x[i], number);
    double relative[3];
    for (int axis = 0; axis < 3; ++axis) relative[axis] = atom->v[i][axis] - of_wall[axis];
    const double before = distance + dot(relative, normal) * update->dt;
    if (before <= distance) return 0.0;

    const double effective = units_.length * radius;
    const double overlap = units_.length * (radius - distance);
    const double earlier = units_.length * std::fmax(0.0, radius - before);
    const int type = atom->type[i], types = atom->ntypes + 1;
    AmberfieldContact pair = contact(type);
    pair.work_function_ev[1] = wall.work;
    pair.growth = (amberfield_contact_area(effective, overlap) - amberfield_contact_area(effective, earlier))
        * area_factors_[type * types + type];
    pair.charge[0] = atom->q[i] * units_.charge;
    pair.radius[0] = pair.radius[1] = effective;

    const double image = image_at(i, normal, distance);
    amberfield::KeptCharges::Contact place = {number_of_wall, image != 0.0, {}, {}, radius};
    for (int axis = 0; axis < 3; ++axis) {
        place.place[axis] = atom->x[i][axis] + normal[axis] * distance;
        place.inward[axis] = -normal[axis];
    }
    if (field_) pair.normal_field = field_at_wall(i, place, image) * units_.field;
    double moved;
    if (wall.keeps) {
        kept_->cover(place.radius);
        const amberfield::KeptCharges::Felt felt = kept_->felt(place);
        moved = amberfield_charge_to_insulating_wall(&pair, felt.normal_field * units_.field,
                                                     felt.per_charge / (units_.length * units_.length))
            / units_.charge;
        kept_->leave(place, atom->tag_enable ? atom->tag[i] : 0, number, moved);
    } else {
        moved = amberfield_charge_to_grounded_wall(&pair) / units_.charge;
    }
    gained_[i] -= moved;
    relaxed_[i] += amberfield_relaxation(&pair);
    return moved;
}

// Sign of E along the normal of a grain's own image where a wall is a face of the field: 1 for a conductor,
// -1 for a surface with a given field, 0 for a wall that the field does not know.
double FixAmberfieldCharge::image_at(int i, const double *normal, double distance) const
{
    if (!field_) return 0.0;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        const double place = face % 2 ? domain->boxhi[axis] : domain->boxlo[axis];
        const double outward = face % 2 ? 1.0 : -1.0;
        const double length = domain->boxhi[axis] - domain->boxlo[axis];
        const double beyond = atom->x[i][axis] + normal[axis] * distance - place;
        if (normal[axis] * outward < 1.0 - ON_FACE || std::abs(beyond) > ON_FACE * length) continue;
        const uint64_t kind = field_->words().faces[face].boundary;
        if (kind == AmberfieldBoundary_Open || kind == AmberfieldBoundary_Periodic) return 0.0;
        return kind == AmberfieldBoundary_NormalField ? -1.0 : 1.0;
    }
    return 0.0;
}

// E along the normal towards a wall of everything but the grain, its image, and the charge that the wall
// keeps around, in LAMMPS' units.
double FixAmberfieldCharge::field_at_wall(int i, const amberfield::KeptCharges::Contact &contact,
                                          double image) const
{
    const double *x = atom->x[i];
    const double out[3] = {-contact.inward[0], -contact.inward[1], -contact.inward[2]};
    double distance = 0.0;
    for (int axis = 0; axis < 3; ++axis) distance += (contact.place[axis] - x[axis]) * out[axis];
    // Where the wall is a face, E has the image of the grain in it.
    double others = dot(seen_[i].e, out) - image * coulomb_ * seen_[i].charge / (4.0 * distance * distance);
    if (words_.walls[contact.wall].keeps) return others - kept_->in_evaluation(contact, x, out, image);
    if (image != 0.0) return others;

    // A grounded wall that the field does not know doubles the field of charges, as images would, and leaves
    // that of the faces' potentials as it is.
    double length[3], given[3];
    for (int axis = 0; axis < 3; ++axis) length[axis] = units_.length * domain->prd[axis];
    if (!field_->words().given_field(length, given)) {
        const std::string me = "fix " + std::string(id) + " amberfield/charge: ";
        error->one(FLERR, me + "a wall inside a box whose faces make a field that differs from place to "
                               "place is not possible; give the faces the same potential, or place the wall "
                               "on a face");
    }
    return 2.0 * others - dot(given, out) / units_.field;
}
