// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "gathered_field.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "update.h"

#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

using namespace LAMMPS_NS;
using amberfield::GatheredField;

namespace {

// Room that an open face gets beyond the farthest charge, over the extent of all of them: so the box, and
// with it the parameters, stay for a while.
constexpr double ROOM = 0.1;

}    // namespace

GatheredField::GatheredField(LAMMPS *lmp, const char *fix, int groupbit, const FieldWords &words,
                             const Units &units) :
    Pointers(lmp), fix_(fix), groupbit_(groupbit), words_(words), units_(units), low_{}, high_{},
    counts_(comm->nprocs), starts_(comm->nprocs), counts3_(comm->nprocs), starts3_(comm->nprocs)
{
    MPI_Comm machine;
    MPI_Comm_split_type(world, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    MPI_Comm_size(machine, &beside_);
    MPI_Comm_free(&machine);
}

GatheredField::~GatheredField()
{
    close();
}

bool GatheredField::follow_box()
{
    bool changed = false;
    for (int axis = 0; axis < 3; ++axis) {
        // Open faces follow the charges instead.
        if (!words_.is_open(2 * axis)) {
            changed |= low_[axis] != domain->boxlo[axis];
            low_[axis] = domain->boxlo[axis];
        }
        if (!words_.is_open(2 * axis + 1)) {
            changed |= high_[axis] != domain->boxhi[axis];
            high_[axis] = domain->boxhi[axis];
        }
    }
    if (changed) close();
    return changed;
}

// Widens the box at open faces where charges are beyond it; on rank 0.
void GatheredField::fit_open_faces()
{
    bool changed = false;
    for (int axis = 0; axis < 3; ++axis) {
        const bool open[2] = {words_.is_open(2 * axis), words_.is_open(2 * axis + 1)};
        if (!open[0] && !open[1]) continue;
        double low = domain->boxlo[axis], high = domain->boxhi[axis];
        for (size_t i = axis; i < places_.size(); i += 3) {
            low = std::min(low, places_[i] / units_.length);
            high = std::max(high, places_[i] / units_.length);
        }
        const double room = ROOM * (high - low);
        if (open[0] && (host_ == nullptr || low < low_[axis])) {
            low_[axis] = low - room;
            changed = true;
        }
        if (open[1] && (host_ == nullptr || high > high_[axis])) {
            high_[axis] = high + room;
            changed = true;
        }
    }
    if (changed) close();
}

void GatheredField::open()
{
    AmberfieldHostSettings settings = {};
    for (int axis = 0; axis < 3; ++axis) {
        settings.low[axis] = low_[axis] * units_.length;
        settings.high[axis] = high_[axis] * units_.length;
    }
    std::copy(words_.faces, words_.faces + 6, settings.faces);
    settings.tolerance = words_.tolerance;
    settings.relative_permittivity = words_.permittivity;
    settings.neutralising_background = words_.background;
    // The same parameters on every machine and for every number of ranks.
    settings.model_tuning = 1;
    if (!words_.openfoam_case.empty()) settings.openfoam_case = words_.openfoam_case.c_str();
    settings.threads = threads();
    host_ = amberfield_host_open(&settings);
    if (amberfield_host_error(host_)[0] == '\0' && !given_parameters_.empty()) {
        amberfield_host_use_parameters(host_, given_parameters_.c_str());
    }
    given_parameters_.clear();
}

void GatheredField::close()
{
    amberfield_host_close(host_);
    host_ = nullptr;
}

// Threads of rank 0: OMP_NUM_THREADS, or its share of the cores that it may use.
int GatheredField::threads() const
{
    const char *asked = std::getenv("OMP_NUM_THREADS");
    const int number = asked ? std::atoi(asked) : 0;
    if (number > 0) return number;
    cpu_set_t mask;
    CPU_ZERO(&mask);
    const int cores = sched_getaffinity(0, sizeof(mask), &mask) == 0 ? CPU_COUNT(&mask) : 1;
    return std::max(1, cores / beside_);
}

double GatheredField::time() const
{
    return update->atime + (update->ntimestep - update->atimestep) * update->dt;
}

double GatheredField::coulomb() const
{
    const double si = amberfield_coulomb(words_.permittivity);
    return si * units_.charge / (units_.length * units_.length * units_.field);
}

// Ends the run where an atom has no place in the box of the field.
void GatheredField::check_place(int i) const
{
    const auto refuse = [&](const std::string &what) {
        const std::string id = atom->tag_enable ? std::to_string(atom->tag[i]) : "without an id";
        error->one(FLERR, "fix " + fix_ + " amberfield/field: atom " + id + " " + what);
    };
    if (!std::isfinite(atom->q[i])) refuse("has no finite charge");
    for (int axis = 0; axis < 3; ++axis) {
        const double place = atom->x[i][axis];
        if (!std::isfinite(place)) refuse("has no finite place");
        if (!words_.openfoam_case.empty() || words_.is_periodic(axis)) continue;
        const bool below = place < low_[axis] && !words_.is_open(2 * axis);
        const bool above = place > high_[axis] && !words_.is_open(2 * axis + 1);
        if (below || above) {
            refuse("is beyond the face " + std::string(FACE_NAMES[2 * axis + above]) + " at "
                   + std::to_string(below ? low_[axis] : high_[axis])
                   + ", which is no open one; keep atoms inside by a wall");
        }
    }
}

// Brings places and charges of the group to rank 0, in SI and in the order of the atoms' ids.
void GatheredField::gather()
{
    own_.clear();
    own_places_.clear();
    own_charges_.clear();
    own_tags_.clear();
    for (int i = 0; i < atom->nlocal; ++i) {
        if (!(atom->mask[i] & groupbit_)) continue;
        check_place(i);
        own_.push_back(i);
        for (int axis = 0; axis < 3; ++axis) own_places_.push_back(atom->x[i][axis] * units_.length);
        own_charges_.push_back(atom->q[i] * units_.charge);
        own_tags_.push_back(atom->tag_enable ? atom->tag[i] : 0);
    }
    const int count = own_.size();
    MPI_Gather(&count, 1, MPI_INT, counts_.data(), 1, MPI_INT, 0, world);
    int all = 0;
    if (comm->me == 0) {
        for (int rank = 0; rank < comm->nprocs; ++rank) {
            starts_[rank] = all;
            counts3_[rank] = 3 * counts_[rank];
            starts3_[rank] = 3 * all;
            all += counts_[rank];
        }
    }
    gathered_.resize(3 * all);
    tags_.resize(all);
    places_.resize(3 * all);
    charges_.resize(all);
    order_.resize(all);

    MPI_Gatherv(own_tags_.data(), count, MPI_LMP_TAGINT, tags_.data(), counts_.data(), starts_.data(),
                MPI_LMP_TAGINT, 0, world);
    MPI_Gatherv(own_charges_.data(), count, MPI_DOUBLE, gathered_.data(), counts_.data(), starts_.data(),
                MPI_DOUBLE, 0, world);
    // The same order for any number of ranks, so that the library sees the same numbers.
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(), [this](int a, int b) { return tags_[a] < tags_[b]; });
    for (int k = 0; k < all; ++k) charges_[k] = gathered_[order_[k]];
    MPI_Gatherv(own_places_.data(), 3 * count, MPI_DOUBLE, gathered_.data(), counts3_.data(),
                starts3_.data(), MPI_DOUBLE, 0, world);
    for (int k = 0; k < all; ++k) {
        std::copy_n(&gathered_[3 * order_[k]], 3, &places_[3 * k]);
    }
    if (comm->me == 0) {
        places_.insert(places_.end(), wall_places_.begin(), wall_places_.end());
        charges_.insert(charges_.end(), wall_charges_.begin(), wall_charges_.end());
        fit_open_faces();
        if (host_ == nullptr) open();
    }
}

void GatheredField::set_charges_of_walls(const std::vector<double> &places,
                                         const std::vector<double> &charges)
{
    wall_places_ = places;
    wall_charges_ = charges;
    for (double &place : wall_places_) place *= units_.length;
    for (double &charge : wall_charges_) charge *= units_.charge;
}

bool GatheredField::has_charges() const
{
    return std::any_of(charges_.begin(), charges_.end(), [](double q) { return q != 0.0; });
}

void GatheredField::evaluate(double **e, bool recheck)
{
    gather();
    bool failed = false;
    if (comm->me == 0) {
        e_.resize(places_.size());
        // Parameters for no charges say nothing about the first ones.
        const bool first_charges = !is_charged_ && has_charges();
        is_charged_ |= first_charges;
        failed = amberfield_host_error(host_)[0] != '\0';
        if (!failed && (recheck || first_charges)) {
            failed = amberfield_host_recheck(host_, charges_.size(), places_.data(), charges_.data())
                != AmberfieldStatus_Ok;
        }
        failed = failed
            || amberfield_host_field(host_, time(), charges_.size(), places_.data(), charges_.data(),
                                     e_.data(), nullptr)
                != AmberfieldStatus_Ok;
        if (!failed) {
            const double measured = amberfield_host_measured_error(host_);
            if (measured >= 0.0) measured_error_ = measured;
            for (size_t k = 0; k < order_.size(); ++k) std::copy_n(&e_[3 * k], 3, &gathered_[3 * order_[k]]);
        }
    }
    check(failed);
    MPI_Bcast(&measured_error_, 1, MPI_DOUBLE, 0, world);
    MPI_Scatterv(gathered_.data(), counts3_.data(), starts3_.data(), MPI_DOUBLE, own_places_.data(),
                 own_places_.size(), MPI_DOUBLE, 0, world);
    for (size_t k = 0; k < own_.size(); ++k) {
        for (int axis = 0; axis < 3; ++axis) e[own_[k]][axis] = own_places_[3 * k + axis] / units_.field;
    }
}

GatheredField::Energy GatheredField::energy()
{
    gather();
    double energies[2] = {0.0, 0.0};
    bool failed = false;
    if (comm->me == 0) {
        failed = amberfield_host_error(host_)[0] != '\0'
            || amberfield_host_energy(host_, time(), charges_.size(), places_.data(), charges_.data(),
                                      &energies[0], &energies[1])
                != AmberfieldStatus_Ok;
    }
    check(failed);
    MPI_Bcast(energies, 2, MPI_DOUBLE, 0, world);
    return {energies[0] / units_.energy, energies[1] / units_.energy};
}

void GatheredField::check(bool failed)
{
    int length = 0;
    std::string reason;
    if (failed) {
        std::vector<tagint> ids(order_.size());
        for (size_t k = 0; k < ids.size(); ++k) ids[k] = tags_[order_[k]];
        reason = message_of_library(amberfield_host_error(host_), ids);
        length = reason.size();
    }
    int state[2] = {failed ? 1 : 0, length};
    MPI_Bcast(state, 2, MPI_INT, 0, world);
    if (!state[0]) return;
    reason.resize(state[1]);
    MPI_Bcast(&reason[0], state[1], MPI_CHAR, 0, world);
    error->all(FLERR, "fix " + fix_ + " amberfield/field: " + reason);
}

std::string GatheredField::parameters() const
{
    return host_ ? amberfield_host_parameters(host_) : given_parameters_;
}
