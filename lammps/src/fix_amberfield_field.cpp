// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "fix_amberfield_field.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "modify.h"
#include "update.h"

#include <mpi.h>

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

namespace {

// Way that an atom goes in an interval at most, over its radius
constexpr double TRAVEL = 0.5;
// Two sums over all atoms are equal up to rounding, relative to the sum of the sizes
constexpr double SAME = 1e-12;
// Error of the forecast that is allowed at least, over the tolerance, where the field has taken the rest
constexpr double LEAST = 0.3;
// Evaluations after which the error is measured again, the first time and from then on, as in amberfield's
// own runs: each time costs several evaluations
constexpr double RECHECK[2] = {200, 1000};

}    // namespace

FixAmberfieldField::FixAmberfieldField(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), units_(amberfield::Units::of(lmp, arg[2])),
    words_(amberfield::FieldWords::read(amberfield::Words(lmp, narg, arg), units_)),
    source_(lmp, arg[0], groupbit, words_, units_), forecast_(lmp)
{
    scalar_flag = 1;
    extscalar = 1;
    vector_flag = 1;
    size_vector = 4;
    extvector = 0;
    global_freq = 1;
    peratom_flag = 1;
    size_peratom_cols = 3;
    peratom_freq = 1;
    energy_global_flag = 1;
    virial_global_flag = 1;
    virial_peratom_flag = 0;
    restart_global = 1;
    restart_peratom = 1;
    create_attribute = 1;
    dynamic_group_allow = 0;
    maxexchange = amberfield::Forecast::SIZE;

    FixAmberfieldField::grow_arrays(atom->nmax);
    atom->add_callback(Atom::GROW);
    atom->add_callback(Atom::RESTART);
    for (int i = 0; i < atom->nlocal; ++i) set_arrays(i);
}

FixAmberfieldField::~FixAmberfieldField()
{
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
}

int FixAmberfieldField::setmask()
{
    return POST_FORCE | MIN_POST_FORCE | POST_RUN;
}

void FixAmberfieldField::init()
{
    // The charge transfer gives what walls keep, where there are such walls.
    if (modify->get_fix_by_style("amberfield/charge").empty()) kept_ = nullptr;
    check_setting();
}

void FixAmberfieldField::setup(int vflag)
{
    start(vflag);
}

void FixAmberfieldField::min_setup(int vflag)
{
    is_fresh_due_ = true;
    start(vflag);
}

// Begins a run. What an earlier one or a restart file knows of E goes on where nothing was changed since.
void FixAmberfieldField::start(int vflag)
{
    if (is_restarted_) {
        is_restarted_ = false;
        source_.follow_box();
        is_fresh_due_ = false;
    } else if (!is_fresh_due_) {
        const std::vector<double> now = fingerprint();
        bool same = now.size() == left_at_.size();
        for (size_t k = 0; same && k < now.size(); k += 2) {
            same = std::abs(now[k] - left_at_[k]) <= SAME * std::max(now[k + 1], left_at_[k + 1]);
        }
        is_fresh_due_ = !same;
    }
    // The step may have another number by now.
    last_step_ = update->ntimestep;
    energy_step_ = -1;
    post_force(vflag);
}

void FixAmberfieldField::post_run()
{
    left_at_ = fingerprint();
}

void FixAmberfieldField::min_post_force(int vflag)
{
    is_fresh_due_ = true;
    post_force(vflag);
}

void FixAmberfieldField::post_force(int vflag)
{
    const bigint steps = update->ntimestep - last_step_;
    interval_.age += steps;
    last_step_ = update->ntimestep;
    // The line through two evaluations counts in steps.
    if (update->dt != last_dt_ && last_dt_ > 0.0) is_fresh_due_ = true;
    last_dt_ = update->dt;
    energy_step_ = -1;
    const Census now = carry_on(steps);
    if (is_due(now)) evaluate(now);
    v_init(vflag);
    if (vflag_global) add_virial();
}

// Lays E on by some steps, adds qE, and takes the census. Every step goes through all atoms here, and once.
FixAmberfieldField::Census FixAmberfieldField::carry_on(double steps)
{
    double sums[3] = {0.0, 0.0, 0.0};
    const int *mask = atom->mask;
    const double *q = atom->q, *charge = forecast_.charge;
    for (int i = 0, atoms = atom->nlocal; i < atoms; ++i) {
        if (!(mask[i] & groupbit)) continue;
        const double *slope = forecast_.slope[i];
        double *e = forecast_.e[i], *f = atom->f[i];
        for (int axis = 0; axis < 3; ++axis) {
            e[axis] += steps * slope[axis];
            f[axis] += q[i] * e[axis];
        }
        const double change = q[i] - charge[i];
        sums[0] += change * change;
        sums[1] += q[i] * q[i];
        sums[2] += 1.0;
    }
    double all[3];
    MPI_Allreduce(sums, all, 3, MPI_DOUBLE, MPI_SUM, world);
    return {all[0], all[1], all[2]};
}

// Whether E must be evaluated in this step.
bool FixAmberfieldField::is_due(const Census &now)
{
    const bool box_changed = source_.follow_box();
    // Charges that are no numbers are refused where places and charges are looked at.
    const bool others = !std::isfinite(now.changed) || now.count != evaluated_count_;
    const bool charges_changed =
        words_.every == 0 && now.changed > words_.tolerance * words_.tolerance * now.squares;
    // Where atoms came or went, E has jumped, and no line goes through the jump.
    if (box_changed || is_fresh_due_ || others) interval_.restart();
    const bool due = is_fresh_due_ || box_changed || others || charges_changed || interval_.is_due();
    is_fresh_due_ = false;
    return due;
}

// Evaluates E, checks the forecast that it replaces, and corrects the line and the forces.
void FixAmberfieldField::evaluate(const Census &now)
{
    const int atoms = atom->nlocal;
    fresh_.resize(3 * atoms);
    rows_.resize(atoms);
    for (int i = 0; i < atoms; ++i) rows_[i] = &fresh_[3 * i];
    const double count = interval_.evaluations;
    const bool recheck = count == RECHECK[0] || (count > 0.0 && std::fmod(count, RECHECK[1]) == 0.0);
    give_kept_charges();
    source_.evaluate(rows_.data(), recheck);
    for (int i = 0; kept_ && i < atoms; ++i) {
        if (atom->mask[i] & groupbit) kept_->soften(atom->x[i], rows_[i]);
    }

    const double age = interval_.age;
    // Sums of q^2 |change|^2, |change|^2, q^2 |E|^2, atoms; and the largest |change|^2
    double sums[4] = {0.0, 0.0, 0.0, 0.0}, largest = 0.0;
    for (int i = 0; i < atoms; ++i) {
        if (!(atom->mask[i] & groupbit)) {
            forecast_.clear(i);
            continue;
        }
        const double q = atom->q[i];
        double change2 = 0.0, size2 = 0.0;
        const bool knows = forecast_.knows(i) && age > 0.0;
        // A line through a charge that jumped would go on jumping.
        const bool jumped = std::abs(q - forecast_.charge[i]) > words_.tolerance * std::abs(q);
        for (int axis = 0; axis < 3; ++axis) {
            const double fresh = rows_[i][axis], correction = fresh - forecast_.e[i][axis];
            const double change = knows ? correction : 0.0;
            change2 += change * change;
            size2 += fresh * fresh;
            double &slope = forecast_.slope[i][axis];
            slope = knows ? slope + (jumped ? 0.0 : change / age) : 0.0;
            forecast_.e[i][axis] = fresh;
            atom->f[i][axis] += q * correction;
        }
        const double weight = q * q;
        sums[0] += weight * change2;
        sums[1] += change2;
        sums[2] += weight * size2;
        sums[3] += knows ? 1.0 : 0.0;
        largest = std::max(largest, change2);
        forecast_.charge[i] = q;
    }
    double all[4], most;
    MPI_Allreduce(sums, all, 4, MPI_DOUBLE, MPI_SUM, world);
    MPI_Allreduce(&largest, &most, 1, MPI_DOUBLE, MPI_MAX, world);

    const double size = scale(all, now);
    follow_error_of_field(size, now);
    amberfield::Interval::Check check;
    if (size > 0.0 && all[3] > 0.0 && now.squares > 0.0) {
        check.drift = std::sqrt(all[0] / now.squares) / size;
        check.drift_of_all = std::sqrt(all[1] / all[3]) / size;
        check.largest = std::sqrt(most) / size;
    }
    const bool checked = all[3] > 0.0;
    interval_.evaluated(checked ? &check : nullptr, words_.every, aim(), longest());
    evaluated_count_ = now.count;
}

// Error that a forecast may have at the end of an interval: what the field leaves of the tolerance.
double FixAmberfieldField::aim() const
{
    const double tolerance = words_.tolerance, of_field = error_of_field();
    const double left = tolerance * tolerance - of_field * of_field;
    return std::sqrt(std::max(left, std::pow(LEAST * tolerance, 2)));
}

// Takes what was measured of the field's error, and how strong E is by now for these charges: the error does
// not grow with E where charges come closer to each other.
void FixAmberfieldField::follow_error_of_field(double scale, const Census &now)
{
    strength_ = now.squares > 0.0 ? scale / std::sqrt(now.squares / now.count) : 0.0;
    if (source_.measured_error() < 0.0 || source_.measured_error() == measured_) return;
    measured_ = source_.measured_error();
    measured_at_ = strength_;
}

double FixAmberfieldField::error_of_field() const
{
    return strength_ > 0.0 ? measured_ * measured_at_ / strength_ : 0.0;
}

// Scale of E: its RMS over the charges, or that of as many charges at random where they cancel.
double FixAmberfieldField::scale(const double *sums, const Census &now) const
{
    if (now.squares == 0.0 || now.count == 0.0) return 0.0;
    const double volume = domain->xprd * domain->yprd * domain->zprd;
    const double charge = std::sqrt(now.squares / now.count);
    const double random = coulomb() * charge * std::pow(now.count / volume, 2.0 / 3.0);
    return std::max(std::sqrt(sums[2] / now.squares), random);
}

// Steps in which no atom goes farther than a share of its radius.
double FixAmberfieldField::longest() const
{
    double least = 1e18;
    if (atom->radius_flag) {
        for (int i = 0; i < atom->nlocal; ++i) {
            if (!(atom->mask[i] & groupbit)) continue;
            const double *v = atom->v[i];
            const double step = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * update->dt;
            if (step > 0.0) least = std::min(least, TRAVEL * atom->radius[i] / step);
        }
    }
    double all;
    MPI_Allreduce(&least, &all, 1, MPI_DOUBLE, MPI_MIN, world);
    return all;
}

// Lets the field have the charges on walls as they are.
void FixAmberfieldField::give_kept_charges()
{
    std::vector<double> places, charges;
    if (kept_) kept_->sources(places, charges);
    source_.set_charges_of_walls(places, charges);
}

amberfield::SharedField::Energy FixAmberfieldField::energy()
{
    if (energy_step_ != update->ntimestep) {
        if (source_.follow_box()) is_fresh_due_ = true;
        give_kept_charges();
        energy_ = source_.energy();
        energy_step_ = update->ntimestep;
    }
    return energy_;
}

// Electric energy at present, evaluated once more: the force is its slope.
double FixAmberfieldField::compute_scalar()
{
    const amberfield::SharedField::Energy now = energy();
    return now.of_charges + now.of_faces;
}

double FixAmberfieldField::compute_vector(int n)
{
    switch (n) {
        case 0: return std::hypot(error_of_field(), interval_.error());
        case 1: return static_cast<double>(interval_.steps);
        case 2: return interval_.evaluations;
        default: return std::hypot(error_of_field(), interval_.error_of_run());
    }
}

// Sums of r F along axes that are not periodic. All energies of charges go as one over the length: what is
// left of it is the share of periodic axes together.
void FixAmberfieldField::add_virial()
{
    static const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    int periodic = 0;
    for (int axis = 0; axis < 3; ++axis) periodic += words_.is_periodic(axis);
    const double whole = periodic > 0 ? energy().of_charges : 0.0;
    double along = 0.0;
    for (int i = 0; i < atom->nlocal; ++i) {
        if (!(atom->mask[i] & groupbit)) continue;
        for (int k = 0; k < 6; ++k) {
            const int a = pairs[k][0], b = pairs[k][1];
            // Along a periodic axis a place has no meaning.
            const int place = words_.is_periodic(a) ? b : a, force = words_.is_periodic(a) ? a : b;
            if (words_.is_periodic(place)) continue;
            const double share = atom->x[i][place] * atom->q[i] * array_atom[i][force];
            virial[k] += share;
            if (a == b) along += share;
        }
    }
    for (int k = 0; k < 3; ++k) {
        if (words_.is_periodic(k)) virial[k] += ((comm->me == 0 ? whole : 0.0) - along) / periodic;
    }
}

std::vector<double> FixAmberfieldField::fingerprint() const
{
    // Pairs of a sum and of the sum of the sizes of its terms
    std::vector<double> sums(10, 0.0), all(10);
    for (int i = 0; i < atom->nlocal; ++i) {
        if (!(atom->mask[i] & groupbit)) continue;
        double place[3];
        domain->unmap(atom->x[i], atom->image[i], place);
        const double terms[5] = {place[0], place[1], place[2], atom->q[i], 1.0};
        // Ids as weights: atoms that change places are seen.
        const double weight = atom->tag_enable ? 1.0 + atom->tag[i] % 1009 : 1.0;
        for (int k = 0; k < 5; ++k) {
            sums[2 * k] += weight * terms[k];
            sums[2 * k + 1] += weight * std::abs(terms[k]);
        }
    }
    MPI_Allreduce(sums.data(), all.data(), 10, MPI_DOUBLE, MPI_SUM, world);
    return all;
}
