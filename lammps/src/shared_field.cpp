// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "shared_field.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "update.h"

#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>

using namespace LAMMPS_NS;
using amberfield::SharedField;

namespace {

// Room that an open face gets beyond the farthest charge, over the extent of all of them: so the box, and
// with it the parameters, stay for a while.
constexpr double ROOM = 0.1;
// Share of the tolerance that the library gets, where forecasts take the rest: an interval gains more by a
// larger share than an evaluation loses by a smaller one
constexpr double OF_FIELD = 0.6;
// Least tolerance that the library takes
constexpr double LEAST_TOLERANCE = 1e-15;

}    // namespace

SharedField::SharedField(LAMMPS *lmp, const char *fix, int groupbit, const FieldWords &words,
                         const Units &units) :
    Pointers(lmp), fix_(fix), groupbit_(groupbit), words_(words), units_(units), ranks_(world), low_{},
    high_{}
{
    MPI_Comm machine;
    MPI_Comm_split_type(world, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    MPI_Comm_size(machine, &beside_);
    MPI_Comm_free(&machine);
}

SharedField::~SharedField()
{
    close();
}

bool SharedField::follow_box()
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

// Widens the box at open faces where charges are beyond it.
void SharedField::fit_open_faces()
{
    bool is_open = false;
    for (int face = 0; face < 6; ++face) is_open |= words_.is_open(face);
    if (!is_open) return;
    // Lowest coordinates, and highest ones with the other sign
    double ends[6];
    for (int axis = 0; axis < 3; ++axis) {
        ends[2 * axis] = domain->boxlo[axis];
        ends[2 * axis + 1] = -domain->boxhi[axis];
        for (size_t i = axis; i < places_.size(); i += 3) {
            ends[2 * axis] = std::min(ends[2 * axis], places_[i] / units_.length);
            ends[2 * axis + 1] = std::min(ends[2 * axis + 1], -places_[i] / units_.length);
        }
    }
    MPI_Allreduce(MPI_IN_PLACE, ends, 6, MPI_DOUBLE, MPI_MIN, world);
    bool changed = false;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = ends[2 * axis], high = -ends[2 * axis + 1], room = ROOM * (high - low);
        if (words_.is_open(2 * axis) && (host_ == nullptr || low < low_[axis])) {
            low_[axis] = low - room;
            changed = true;
        }
        if (words_.is_open(2 * axis + 1) && (host_ == nullptr || high > high_[axis])) {
            high_[axis] = high + room;
            changed = true;
        }
    }
    if (changed) close();
}

void SharedField::open()
{
    AmberfieldHostSettings settings = {};
    for (int axis = 0; axis < 3; ++axis) {
        settings.low[axis] = low_[axis] * units_.length;
        settings.high[axis] = high_[axis] * units_.length;
    }
    std::copy(words_.faces, words_.faces + 6, settings.faces);
    settings.tolerance =
        std::max((words_.every == 1 ? 1.0 : OF_FIELD) * words_.tolerance, LEAST_TOLERANCE);
    settings.relative_permittivity = words_.permittivity;
    settings.neutralising_background = words_.background;
    // The same parameters on every machine and for every number of ranks.
    settings.model_tuning = 1;
    if (!words_.openfoam_case.empty()) settings.openfoam_case = words_.openfoam_case.c_str();
    settings.threads = threads();
    // One rank alone may sum a few charges in open space one by one.
    host_ = comm->nprocs > 1 ? amberfield_host_open_over_ranks(&settings, ranks_.table())
                             : amberfield_host_open(&settings);
    const std::string reason = amberfield_host_error(host_);
    int failed = !reason.empty(), any;
    MPI_Allreduce(&failed, &any, 1, MPI_INT, MPI_MAX, world);
    if (failed) error->one(FLERR, "fix " + fix_ + " amberfield/field: " + reason);
    // The rank that failed ends all.
    if (any) MPI_Barrier(world);
    if (!given_parameters_.empty()) {
        check(amberfield_host_use_parameters(host_, given_parameters_.c_str()));
    }
    given_parameters_.clear();
}

void SharedField::close()
{
    amberfield_host_close(host_);
    host_ = nullptr;
}

// Threads of this rank: OMP_NUM_THREADS, or its share of the cores that it may use.
int SharedField::threads() const
{
    const char *asked = std::getenv("OMP_NUM_THREADS");
    const int number = asked ? std::atoi(asked) : 0;
    if (number > 0) return number;
    cpu_set_t mask;
    CPU_ZERO(&mask);
    const int cores = sched_getaffinity(0, sizeof(mask), &mask) == 0 ? CPU_COUNT(&mask) : 1;
    return std::max(1, cores / beside_);
}

double SharedField::time() const
{
    return update->atime + (update->ntimestep - update->atimestep) * update->dt;
}

double SharedField::coulomb() const
{
    const double si = amberfield_coulomb(words_.permittivity);
    return si * units_.charge / (units_.length * units_.length * units_.field);
}

// Ends the run where an atom has no place in the box of the field.
void SharedField::check_place(int i) const
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

// Takes places and charges of the group, in SI.
void SharedField::collect()
{
    own_.clear();
    places_.clear();
    charges_.clear();
    for (int i = 0; i < atom->nlocal; ++i) {
        if (!(atom->mask[i] & groupbit_)) continue;
        check_place(i);
        own_.push_back(i);
        for (int axis = 0; axis < 3; ++axis) places_.push_back(atom->x[i][axis] * units_.length);
        charges_.push_back(atom->q[i] * units_.charge);
    }
    collect_charges_of_walls();
    fit_open_faces();
    if (host_ == nullptr) open();
}

void SharedField::set_charges_of_walls(const std::vector<double> &places, const std::vector<double> &charges)
{
    wall_places_ = places;
    wall_charges_ = charges;
}

// Adds the charges on walls that lie in this rank's piece of the box.
void SharedField::collect_charges_of_walls()
{
    for (size_t k = 0; k < wall_charges_.size(); ++k) {
        double place[3];
        std::copy_n(&wall_places_[3 * k], 3, place);
        int at[3];
        if (comm->coord2proc(place, at[0], at[1], at[2]) != comm->me) continue;
        for (const double coordinate : place) places_.push_back(coordinate * units_.length);
        charges_.push_back(wall_charges_[k] * units_.charge);
    }
}

bool SharedField::has_charges() const
{
    int any = std::any_of(charges_.begin(), charges_.end(), [](double q) { return q != 0.0; });
    MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, world);
    return any;
}

void SharedField::evaluate(double **e, bool recheck)
{
    collect();
    // Parameters for no charges say nothing about the first ones.
    const bool first_charges = !is_charged_ && has_charges();
    is_charged_ |= first_charges;
    if (recheck || first_charges) {
        check(amberfield_host_recheck(host_, charges_.size(), places_.data(), charges_.data()));
    }
    e_.resize(places_.size());
    check(amberfield_host_field(host_, time(), charges_.size(), places_.data(), charges_.data(), e_.data(),
                                nullptr));
    const double measured = amberfield_host_measured_error(host_);
    if (measured >= 0.0) measured_error_ = measured;
    for (size_t k = 0; k < own_.size(); ++k) {
        for (int axis = 0; axis < 3; ++axis) e[own_[k]][axis] = e_[3 * k + axis] / units_.field;
    }
}

SharedField::Energy SharedField::energy()
{
    collect();
    double of_charges = 0.0, of_faces = 0.0;
    check(amberfield_host_energy(host_, time(), charges_.size(), places_.data(), charges_.data(),
                                 &of_charges, &of_faces));
    return {of_charges / units_.energy, of_faces / units_.energy};
}

// Ids of what this rank has given to the library, in its order, and of all ranks on rank 0 for an OpenFOAM
// case, which has them there.
std::vector<tagint> SharedField::ids() const
{
    std::vector<tagint> own;
    for (const int i : own_) own.push_back(atom->tag_enable ? atom->tag[i] : 0);
    own.resize(charges_.size(), OF_WALL);
    if (words_.openfoam_case.empty()) return own;
    const int count = own.size();
    std::vector<int> counts(comm->nprocs), starts(comm->nprocs);
    MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, world);
    std::partial_sum(counts.begin(), counts.end() - 1, starts.begin() + 1);
    std::vector<tagint> all(starts.back() + counts.back());
    MPI_Gatherv(own.data(), count, MPI_LMP_TAGINT, all.data(), counts.data(), starts.data(), MPI_LMP_TAGINT,
                0, world);
    return all;
}

void SharedField::check(AmberfieldStatus status)
{
    if (status == AmberfieldStatus_Ok) return;
    // An index is that of the rank that the message names.
    std::string message = amberfield_host_error(host_);
    if (status == AmberfieldStatus_Broken) {
        error->one(FLERR, "fix " + fix_ + " amberfield/field: " + message);
    }
    int rank = 0, read = 0;
    if (std::sscanf(message.c_str(), "rank %d: %n", &rank, &read) == 1 && read > 0) message.erase(0, read);
    message = message_of_library(message, ids());
    int length = message.size();
    MPI_Bcast(&length, 1, MPI_INT, rank, world);
    message.resize(length);
    MPI_Bcast(&message[0], length, MPI_CHAR, rank, world);
    error->all(FLERR, "fix " + fix_ + " amberfield/field: " + message);
}

std::string SharedField::parameters() const
{
    return host_ ? amberfield_host_parameters(host_) : given_parameters_;
}
