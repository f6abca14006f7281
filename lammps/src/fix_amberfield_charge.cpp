// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "fix_amberfield_charge.h"

#include "fix_amberfield_field.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "region.h"
#include "update.h"

#include <mpi.h>

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

namespace {

// Share by which the contacts of a grain may relax in a step. Beyond it the charges at the beginning of the
// step say too little about those at its end.
constexpr double MOST_RELAXATION = 0.5;

}    // namespace

FixAmberfieldCharge::FixAmberfieldCharge(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), units_(amberfield::Units::of(lmp, arg[2])),
    words_(amberfield::ChargeWords::read(amberfield::Words(lmp, narg, arg), units_, lmp)),
    of_walls_(words_.walls.size(), 0.0)
{
    scalar_flag = 1;
    extscalar = 1;
    vector_flag = 1;
    size_vector = 1 + words_.walls.size();
    extvector = 1;
    global_freq = 1;
    restart_global = 1;
    comm_forward = 4;
    comm_reverse = 1;
    dynamic_group_allow = 1;
    if (words_.any_keeps()) {
        kept_ = std::make_shared<amberfield::KeptCharges>(lmp, words_.walls.size());
        array_flag = 1;
        extarray = 0;
        size_array_rows = 0;
        size_array_rows_variable = 1;
        size_array_cols = amberfield::KeptCharges::COLUMNS;
    }
}

int FixAmberfieldCharge::setmask()
{
    return POST_FORCE;
}

void FixAmberfieldCharge::init()
{
    const std::string me = "fix " + std::string(id) + " amberfield/charge: ";
    const auto refuse = [&](const std::string &reason) { error->all(FLERR, me + reason); };
    if (!atom->q_flag || !atom->radius_flag) {
        refuse("atoms have no charge or no radius; use atom_style hybrid sphere charge");
    }
    if (!comm->ghost_velocity) refuse("ghost atoms have no velocity; use comm_modify vel yes");
    if (lmp->kokkos) refuse("package kokkos keeps atoms elsewhere, which is not possible; run without it");
    if (domain->triclinic) refuse("a triclinic box is not possible; use an orthogonal one");
    if (std::string(update->integrate_style).find("respa") == 0) {
        refuse("run_style " + std::string(update->integrate_style) + " is not possible; use verlet");
    }

    field_ = nullptr;
    for (Fix *fix : modify->get_fix_list()) {
        if (fix != this && std::string(fix->style) == style) {
            refuse("fix " + std::string(fix->id) + " is one too; each contact would trade twice");
        }
        if (std::string(fix->style) == "amberfield/field") field_ = static_cast<FixAmberfieldField *>(fix);
    }
    permittivity_ = words_.permittivity > 0.0 ? words_.permittivity : 1.0;
    if (field_) {
        const double of_field = field_->words().permittivity;
        if (words_.permittivity > 0.0 && words_.permittivity != of_field) {
            refuse("permittivity is another one than that of fix " + std::string(field_->id)
                   + "; leave it out here");
        }
        permittivity_ = of_field;
        if (!field_->words().openfoam_case.empty() && !words_.walls.empty()) {
            refuse("walls are not possible beside the case of fix " + std::string(field_->id)
                   + ", whose patches LAMMPS does not know");
        }
    }
    const bool any_periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
    if (field_ && field_->thermo_virial && kept_ && any_periodic) {
        refuse("the virial of a periodic box with charge on walls is not known; use fix_modify "
               + std::string(field_->id) + " virial no");
    }
    coulomb_ = amberfield_coulomb(permittivity_) * units_.charge
        / (units_.length * units_.length * units_.field);
    regions_.clear();
    for (const amberfield::ChargingWall &wall : words_.walls) {
        regions_.push_back(domain->get_region_by_id(wall.region));
        if (!regions_.back()) refuse("region " + wall.region + " of a wall is no longer there");
        regions_.back()->init();
    }
    make_table();
    if (kept_) {
        kept_->begin(largest_radius(), coulomb_);
        size_array_rows = kept_->size();
    }
    if (field_) field_->use_kept_charges(kept_);
    // Each pair once, whatever newton says.
    neighbor->add_request(this, NeighConst::REQ_SIZE | NeighConst::REQ_NEWTON_ON);
}

void FixAmberfieldCharge::init_list(int, NeighList *list)
{
    list_ = list;
}

void FixAmberfieldCharge::make_table()
{
    const int types = atom->ntypes + 1;
    area_factors_.assign(types * types, 1.0);
    for (int a = 1; a < types; ++a) {
        for (int b = 1; b < types; ++b) area_factors_[a * types + b] = words_.area_factor(a, b);
    }
}

// Checks that ghosts reach as far as contacts. Nothing has grown before the first step.
double FixAmberfieldCharge::largest_radius() const
{
    double largest = 0.0;
    for (int i = 0; i < atom->nlocal; ++i) largest = std::max(largest, atom->radius[i]);
    MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, world);
    return largest;
}

void FixAmberfieldCharge::setup(int)
{
    if (kept_) {
        // Positions of the walls at the beginning, from which their velocities follow.
        for (Region *region : regions_) {
            region->prematch();
            if (region->dynamic_check()) region->set_velocity();
        }
    }
    if (comm->get_comm_cutoff() < 2.0 * largest_radius()) {
        error->all(FLERR, "fix " + std::string(id) + " amberfield/charge: ghost atoms reach "
                              + std::to_string(comm->get_comm_cutoff())
                              + ", less than the largest diameter; use a granular pair style");
    }
}

void FixAmberfieldCharge::post_force(int)
{
    const int all = atom->nlocal + atom->nghost;
    gained_.assign(all, 0.0);
    relaxed_.assign(all, 0.0);
    see_ghosts();
    trade_pairs();
    trade_walls();
    check_relaxation();

    // What ghosts gained goes to their owners, and the new charges back to all ghosts.
    comm->reverse_comm(this, 1);
    for (int i = 0; i < atom->nlocal; ++i) atom->q[i] += gained_[i];
    forwarded_ = CHARGE;
    comm->forward_comm(this, 1);
    if (kept_) {
        kept_->settle();
        size_array_rows = kept_->size();
    }
}

// Gives ghosts what a contact sees of the field.
void FixAmberfieldCharge::see_ghosts()
{
    if (!field_) return;
    seen_.resize(atom->nlocal + atom->nghost);
    double **e = field_->field();
    for (int i = 0; i < atom->nlocal; ++i) {
        seen_[i] = {{e[i][0], e[i][1], e[i][2]}, field_->charge_of_field(i)};
    }
    forwarded_ = FIELD;
    comm->forward_comm(this, 4);
}

// A contact with what is the same for all.
AmberfieldContact FixAmberfieldCharge::contact(int type) const
{
    AmberfieldContact contact = {};
    contact.work_function_ev[0] = words_.work[type];
    contact.cutoff = words_.cutoff;
    contact.relative_permittivity = permittivity_;
    contact.breakdown = words_.breakdown;
    return contact;
}

void FixAmberfieldCharge::trade_pairs()
{
    const int *mask = atom->mask;
    const double *radius = atom->radius;
    double **x = atom->x;
    for (int ii = 0; ii < list_->inum; ++ii) {
        const int i = list_->ilist[ii], count = list_->numneigh[i];
        if (!(mask[i] & groupbit)) continue;
        const int *neighbours = list_->firstneigh[i];
        for (int jj = 0; jj < count; ++jj) {
            const int j = neighbours[jj] & NEIGHMASK;
            const double dx = x[j][0] - x[i][0], dy = x[j][1] - x[i][1], dz = x[j][2] - x[i][2];
            const double reach = radius[i] + radius[j];
            // Most pairs of a list do not touch.
            if (dx * dx + dy * dy + dz * dz < reach * reach && mask[j] & groupbit) trade_pair(i, j);
        }
    }
}

// Moves charge between two grains that touch, if they came nearer.
void FixAmberfieldCharge::trade_pair(int i, int j)
{
    double **x = atom->x, **v = atom->v;
    const double reach = atom->radius[i] + atom->radius[j];
    double offset[3], now2 = 0.0, before2 = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        offset[axis] = x[j][axis] - x[i][axis];
        const double then = offset[axis] - (v[j][axis] - v[i][axis]) * update->dt;
        now2 += offset[axis] * offset[axis];
        before2 += then * then;
    }
    if (now2 >= before2) return;

    const double distance = std::sqrt(now2);
    const double overlap = units_.length * (reach - distance);
    const double earlier = units_.length * std::max(0.0, reach - std::sqrt(before2));
    const double effective = units_.length * atom->radius[i] * atom->radius[j] / reach;
    const int types = atom->ntypes + 1;
    AmberfieldContact pair = contact(atom->type[i]);
    pair.work_function_ev[1] = words_.work[atom->type[j]];
    pair.growth = (amberfield_contact_area(effective, overlap) - amberfield_contact_area(effective, earlier))
        * area_factors_[atom->type[i] * types + atom->type[j]];
    const int grains[2] = {i, j};
    for (int k = 0; k < 2; ++k) {
        pair.charge[k] = atom->q[grains[k]] * units_.charge;
        pair.radius[k] = atom->radius[grains[k]] * units_.length;
    }
    if (field_) {
        // The mean of E at both centres, without what each of the two does at the other's.
        double along = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            along += (seen_[i].e[axis] + seen_[j].e[axis]) * offset[axis] / distance;
        }
        const double own = coulomb_ * (seen_[j].charge - seen_[i].charge) / now2;
        pair.normal_field = 0.5 * (along + own) * units_.field;
    }
    const double moved = amberfield_charge_between_grains(&pair) / units_.charge;
    const double relaxed = amberfield_relaxation(&pair);
    gained_[i] -= moved;
    gained_[j] += moved;
    relaxed_[i] += relaxed;
    relaxed_[j] += relaxed;
    moved_ += std::abs(moved);
}

void FixAmberfieldCharge::check_relaxation()
{
    if (!std::isfinite(moved_)) {
        const auto bad = [this](int i) {
            return !std::isfinite(atom->q[i]) || !std::isfinite(atom->x[i][0] + atom->x[i][1] + atom->x[i][2])
                || !std::isfinite(atom->v[i][0] + atom->v[i][1] + atom->v[i][2]);
        };
        int i = 0;
        while (i < atom->nlocal + atom->nghost - 1 && !bad(i)) ++i;
        const std::string me = "fix " + std::string(id) + " amberfield/charge: ";
        error->one(FLERR, me + "atom " + std::to_string(atom->tag[i])
                              + " has no finite charge, place or velocity");
    }
    const double most = relaxed_.empty() ? 0.0 : *std::max_element(relaxed_.begin(), relaxed_.end());
    if (most > MOST_RELAXATION) {
        error->one(FLERR, "fix " + std::string(id) + " amberfield/charge: contacts of a grain relax by "
                              + std::to_string(most) + " in one step, above "
                              + std::to_string(MOST_RELAXATION) + "; make the timestep shorter");
    }
}

// Charge that the walls took.
double FixAmberfieldCharge::compute_scalar()
{
    double sum = 0.0;
    for (size_t wall = 0; wall < of_walls_.size(); ++wall) sum += compute_vector(1 + wall);
    return sum;
}

// Sum of the sizes of all charges that moved, then what each wall took.
double FixAmberfieldCharge::compute_vector(int n)
{
    const double own = n == 0 ? moved_ : of_walls_[n - 1];
    double all;
    MPI_Allreduce(&own, &all, 1, MPI_DOUBLE, MPI_SUM, world);
    return all;
}

// Charge on insulating walls: place, charge, scale and wall of each spot.
double FixAmberfieldCharge::compute_array(int row, int column)
{
    return kept_->number(row, column);
}

double FixAmberfieldCharge::memory_usage()
{
    return static_cast<double>(gained_.capacity() + relaxed_.capacity()) * sizeof(double)
        + static_cast<double>(seen_.capacity()) * sizeof(Seen);
}

double FixAmberfieldCharge::walls() const
{
    return words_.walls.size();
}

double FixAmberfieldCharge::insulators() const
{
    double count = 0.0;
    for (const amberfield::ChargingWall &wall : words_.walls) count += wall.keeps;
    return count;
}

void FixAmberfieldCharge::write_restart(FILE *file)
{
    std::vector<double> sums(1 + of_walls_.size());
    for (size_t n = 0; n < sums.size(); ++n) sums[n] = compute_vector(n);
    if (comm->me != 0) return;
    // How many walls, and how many of them keep charge: a run that goes on must have as many.
    sums.insert(sums.begin(), {walls(), insulators()});
    if (kept_) {
        const std::vector<double> kept = kept_->pack();
        sums.insert(sums.end(), kept.begin(), kept.end());
    }
    const int size = sums.size() * sizeof(double);
    fwrite(&size, sizeof(int), 1, file);
    fwrite(sums.data(), sizeof(double), sums.size(), file);
}

void FixAmberfieldCharge::restart(char *buffer)
{
    const auto *numbers = reinterpret_cast<const double *>(buffer);
    if (numbers[0] != walls() || numbers[1] != insulators()) {
        error->all(FLERR, "fix " + std::string(id) + " amberfield/charge: the restart file has "
                              + std::to_string(static_cast<int>(numbers[0])) + " walls, "
                              + std::to_string(static_cast<int>(numbers[1]))
                              + " of them insulating; give the same ones, or the fix another id");
    }
    numbers += 2;
    const size_t count = of_walls_.size();
    if (comm->me == 0) {
        moved_ = numbers[0];
        std::copy_n(numbers + 1, count, of_walls_.begin());
    }
    if (kept_) kept_->unpack(numbers + 1 + count);
}

int FixAmberfieldCharge::pack_forward_comm(int count, int *list, double *buffer, int, int *)
{
    int m = 0;
    for (int k = 0; k < count; ++k) {
        if (forwarded_ == CHARGE) {
            buffer[m++] = atom->q[list[k]];
            continue;
        }
        const Seen &seen = seen_[list[k]];
        for (double e : seen.e) buffer[m++] = e;
        buffer[m++] = seen.charge;
    }
    return m;
}

void FixAmberfieldCharge::unpack_forward_comm(int count, int first, double *buffer)
{
    int m = 0;
    for (int i = first; i < first + count; ++i) {
        if (forwarded_ == CHARGE) {
            atom->q[i] = buffer[m++];
            continue;
        }
        for (double &e : seen_[i].e) e = buffer[m++];
        seen_[i].charge = buffer[m++];
    }
}

int FixAmberfieldCharge::pack_reverse_comm(int count, int first, double *buffer)
{
    std::copy_n(&gained_[first], count, buffer);
    return count;
}

void FixAmberfieldCharge::unpack_reverse_comm(int count, int *list, double *buffer)
{
    for (int k = 0; k < count; ++k) gained_[list[k]] += buffer[k];
}
