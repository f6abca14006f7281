// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "kept_charges.h"

#include "comm.h"
#include "domain.h"
#include "region.h"
#include "update.h"

#include "amberfield.h"

#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

using namespace LAMMPS_NS;
using amberfield::KeptCharges;

namespace {

constexpr double PI = 3.14159265358979323846;
// Distance from a spot's first place up to which contacts share it, over the smaller of both scales
constexpr double SHARED = 0.75;
// Largest ratio of the scales of contacts that share a spot
constexpr double SIMILAR = 1.25;
// Least cosine of the angle between the normals of contacts that share a spot
constexpr double SAME_SIDE = 0.8;
// Distance of a spot's point charge before the surface, over the scale
constexpr double BEFORE = 0.1;
// Distance up to which a spot is more than its point charge, over the scale
constexpr double NEAR = 3.5;
// Part of the radius by which a contact counts as before its surface: more than round-off
constexpr double IN_FRONT = 0.02;
// Numbers of a spot in restart files
constexpr int NUMBERS = 14;

double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double norm(const double *a)
{
    return std::sqrt(dot(a, a));
}

// Field of a unit point charge over Coulomb's constant.
void add_point_charge(const double *offset, double factor, double *e)
{
    const double distance = norm(offset);
    const double over = factor / (distance * distance * distance);
    for (int k = 0; k < 3; ++k) e[k] += over * offset[k];
}

}    // namespace

KeptCharges::KeptCharges(LAMMPS *lmp, int walls) : Pointers(lmp), walls_(walls), cells_(walls) {}

void KeptCharges::begin(double largest_radius, double coulomb)
{
    coulomb_ = coulomb;
    for (const Spot &spot : spots_) largest_radius = std::max(largest_radius, spot.scale);
    largest_ = largest_radius;
    cell_ = (NEAR + SHARED) * largest_;
    for (auto &cells : cells_) cells.clear();
    for (int spot = 0; spot < size(); ++spot) list(spot);
}

void KeptCharges::cover(double radius)
{
    if (radius > largest_) begin(radius, coulomb_);
}

void KeptCharges::follow(int wall, Region *region)
{
    if (region->moveflag || region->rotateflag) walls_[wall].follow(region, update->dt);
}

void KeptCharges::shortest(double *offset) const
{
    for (int axis = 0; axis < 3; ++axis) {
        if (domain->periodicity[axis]) {
            offset[axis] -= domain->prd[axis] * std::round(offset[axis] / domain->prd[axis]);
        }
    }
}

void KeptCharges::wrap(double *place) const
{
    for (int axis = 0; axis < 3; ++axis) {
        if (!domain->periodicity[axis]) continue;
        const double length = domain->prd[axis];
        place[axis] -= length * std::floor((place[axis] - domain->boxlo[axis]) / length);
    }
}

uint64_t KeptCharges::cell_of(const double *place, int dx, int dy, int dz) const
{
    const int steps[3] = {dx, dy, dz};
    uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t cell = static_cast<int64_t>(std::floor(place[axis] / cell_)) + steps[axis];
        key = (key << 21) | (static_cast<uint64_t>(cell) & 0x1fffff);
    }
    return key;
}

// Lists a spot in its cell, in those around it, and in those of its periodic copies.
void KeptCharges::list(int number)
{
    const Spot &spot = spots_[number];
    double first[3];
    std::copy_n(spot.first, 3, first);
    wrap(first);
    for (int code = 0; code < 27; ++code) {
        const int periods[3] = {code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1};
        double copy[3];
        bool is_there = true;
        for (int axis = 0; axis < 3; ++axis) {
            is_there &= periods[axis] == 0 || domain->periodicity[axis];
            copy[axis] = first[axis] + periods[axis] * domain->prd[axis];
        }
        for (int near = 0; is_there && near < 27; ++near) {
            const uint64_t key = cell_of(copy, near / 9 - 1, near / 3 % 3 - 1, near % 3 - 1);
            std::vector<int> &cell = cells_[spot.wall][key];
            if (cell.empty() || cell.back() != number) cell.push_back(number);
        }
    }
}

// Spots that a grain of a radius feels at a place: those of all walls.
std::vector<KeptCharges::Near> KeptCharges::around(const double *place, double radius) const
{
    std::vector<Near> found;
    for (size_t wall = 0; wall < walls_.size(); ++wall) {
        if (cells_[wall].empty()) continue;
        double home[3];
        walls_[wall].home(place, home);
        wrap(home);
        const auto cell = cells_[wall].find(cell_of(home, 0, 0, 0));
        if (cell == cells_[wall].end()) continue;
        for (int number : cell->second) {
            Near near = {&spots_[number], {}, {}};
            double at[3];
            walls_[wall].out(near.spot->place, at);
            for (int k = 0; k < 3; ++k) near.offset[k] = place[k] - at[k];
            shortest(near.offset);
            if (norm(near.offset) >= NEAR * std::max(near.spot->scale, radius)) continue;
            walls_[wall].turn_out(near.spot->normal, near.normal);
            found.push_back(near);
        }
    }
    return found;
}

// Number of the spot that a contact charges; -1 where there is none yet.
int KeptCharges::shared_spot(const Contact &contact) const
{
    double place[3], inward[3];
    walls_[contact.wall].home(contact.place, place);
    walls_[contact.wall].turn_home(contact.inward, inward);
    double wrapped[3];
    std::copy_n(place, 3, wrapped);
    wrap(wrapped);
    const auto cell = cells_[contact.wall].find(cell_of(wrapped, 0, 0, 0));
    if (cell == cells_[contact.wall].end()) return -1;
    int nearest = -1;
    double least = 0.0;
    for (int number : cell->second) {
        const Spot &spot = spots_[number];
        const double smaller = std::min(spot.scale, contact.radius);
        double offset[3];
        for (int k = 0; k < 3; ++k) offset[k] = place[k] - spot.first[k];
        shortest(offset);
        const double distance = norm(offset);
        const bool is_shared = spot.bounds_field == contact.bounds_field
            && std::max(spot.scale, contact.radius) <= SIMILAR * smaller && distance <= SHARED * smaller
            && dot(spot.normal, inward) > SAME_SIDE;
        if (is_shared && (nearest < 0 || distance < least)) {
            nearest = number;
            least = distance;
        }
    }
    return nearest;
}

KeptCharges::Felt KeptCharges::felt(const Contact &contact) const
{
    const int own = shared_spot(contact);
    // A spot that begins here acts as from a radius away.
    Felt felt = {0.0, own < 0 ? 1.0 / (4.0 * PI * contact.radius * contact.radius) : 0.0};
    for (const Near &near : around(contact.place, contact.radius)) {
        double before[3], field[3];
        for (int k = 0; k < 3; ++k) {
            before[k] = near.offset[k] + IN_FRONT * contact.radius * contact.inward[k];
        }
        amberfield_kept_charge_field(std::max(near.spot->scale, contact.radius), near.normal, near.offset,
                                     dot(before, near.normal), field);
        const double inward = dot(field, contact.inward);
        felt.normal_field += coulomb_ * near.spot->charge * inward;
        if (own >= 0 && near.spot == &spots_[own]) {
            felt.per_charge = std::max(inward, 0.0) / (4.0 * PI);
        }
    }
    return felt;
}

void KeptCharges::leave(const Contact &contact, double atom, int number, double charge)
{
    Left left = {atom, static_cast<double>(contact.wall), static_cast<double>(number),
                 contact.bounds_field ? 1.0 : 0.0, {}, {}, contact.radius, charge};
    std::copy_n(contact.place, 3, left.place);
    std::copy_n(contact.inward, 3, left.inward);
    left_.push_back(left);
}

void KeptCharges::settle()
{
    const int own = left_.size();
    std::vector<int> counts(comm->nprocs), starts(comm->nprocs);
    MPI_Allgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
    const int all = std::accumulate(counts.begin(), counts.end(), 0);
    if (all == 0) return;
    constexpr int WIDTH = sizeof(Left) / sizeof(double);
    for (int rank = 0, start = 0; rank < comm->nprocs; ++rank) {
        counts[rank] *= WIDTH;
        starts[rank] = start;
        start += counts[rank];
    }
    std::vector<Left> of_all(all);
    MPI_Allgatherv(left_.data(), own * WIDTH, MPI_DOUBLE, of_all.data(), counts.data(), starts.data(),
                   MPI_DOUBLE, world);
    left_.clear();
    std::sort(of_all.begin(), of_all.end(), [](const Left &a, const Left &b) {
        return std::tie(a.atom, a.wall, a.number) < std::tie(b.atom, b.wall, b.number);
    });
    for (const Left &left : of_all) {
        Contact contact = {static_cast<int>(left.wall), left.bounds_field != 0.0, {}, {}, left.radius};
        std::copy_n(left.place, 3, contact.place);
        std::copy_n(left.inward, 3, contact.inward);
        add(contact, left.charge);
    }
}

// Adds a charge to its spot, whose place is the mean over all that moved there.
void KeptCharges::add(const Contact &contact, double charge)
{
    const WallPlace &wall = walls_[contact.wall];
    double place[3], inward[3];
    wall.home(contact.place, place);
    wall.turn_home(contact.inward, inward);
    cover(contact.radius);
    int number = shared_spot(contact);
    if (number < 0) {
        Spot spot = {contact.wall, contact.bounds_field, {}, {}, {}, contact.radius, 0.0, 0.0};
        std::copy_n(place, 3, spot.place);
        std::copy_n(place, 3, spot.first);
        std::copy_n(inward, 3, spot.normal);
        number = size();
        spots_.push_back(spot);
        list(number);
    }
    Spot &spot = spots_[number];
    spot.charge += charge;
    spot.moved += std::abs(charge);
    if (spot.moved == 0.0) return;
    const double share = std::abs(charge) / spot.moved;
    double offset[3];
    for (int k = 0; k < 3; ++k) offset[k] = place[k] - spot.place[k];
    shortest(offset);
    for (int k = 0; k < 3; ++k) {
        spot.place[k] += share * offset[k];
        spot.normal[k] += share * (inward[k] - spot.normal[k]);
    }
    const double length = norm(spot.normal);
    for (double &component : spot.normal) component /= length;
    spot.scale += share * (contact.radius - spot.scale);
}

// Place of a spot's point charge, inside the box.
void KeptCharges::source(const Spot &spot, double *place) const
{
    double normal[3];
    walls_[spot.wall].out(spot.place, place);
    walls_[spot.wall].turn_out(spot.normal, normal);
    for (int axis = 0; axis < 3; ++axis) place[axis] += BEFORE * spot.scale * normal[axis];
    wrap(place);
    for (int axis = 0; axis < 3; ++axis) {
        place[axis] = std::clamp(place[axis], domain->boxlo[axis], domain->boxhi[axis]);
    }
}

void KeptCharges::sources(std::vector<double> &places, std::vector<double> &charges) const
{
    places.resize(3 * spots_.size());
    charges.resize(spots_.size());
    for (int spot = 0; spot < size(); ++spot) {
        source(spots_[spot], &places[3 * spot]);
        charges[spot] = spots_[spot].charge;
    }
}

double KeptCharges::in_evaluation(const Contact &contact, const double *centre, const double *out,
                                  double image) const
{
    double sum = 0.0;
    for (const Near &near : around(contact.place, contact.radius)) {
        double e[3] = {0.0, 0.0, 0.0}, from[3];
        if (!near.spot->bounds_field) {
            // E at a grain is that of the law already.
            for (int k = 0; k < 3; ++k) from[k] = near.offset[k] + centre[k] - contact.place[k];
            amberfield_kept_charge_field(near.spot->scale, near.normal, from, dot(from, near.normal), e);
        } else {
            source(*near.spot, from);
            for (int k = 0; k < 3; ++k) from[k] = centre[k] - from[k];
            shortest(from);
            add_point_charge(from, 1.0, e);
            if (image != 0.0 && std::abs(dot(near.offset, contact.inward)) < BEFORE * near.spot->scale) {
                // The plane of the surface lies at the contact.
                double height = -dot(from, out);
                for (int k = 0; k < 3; ++k) height += (centre[k] - contact.place[k]) * out[k];
                double mirrored[3];
                for (int k = 0; k < 3; ++k) mirrored[k] = from[k] + 2.0 * height * out[k];
                add_point_charge(mirrored, -image, e);
            }
        }
        sum += coulomb_ * near.spot->charge * dot(e, out);
    }
    return sum;
}

void KeptCharges::soften(const double *centre, double *e) const
{
    for (const Near &near : around(centre, 0.0)) {
        if (near.spot->bounds_field) continue;
        double by_law[3], from[3];
        amberfield_kept_charge_field(near.spot->scale, near.normal, near.offset,
                                     dot(near.offset, near.normal), by_law);
        source(*near.spot, from);
        for (int k = 0; k < 3; ++k) from[k] = centre[k] - from[k];
        shortest(from);
        add_point_charge(from, -1.0, by_law);
        for (int k = 0; k < 3; ++k) e[k] += coulomb_ * near.spot->charge * by_law[k];
    }
}

double KeptCharges::number(int number, int column) const
{
    const Spot &spot = spots_[number];
    double place[3];
    walls_[spot.wall].out(spot.place, place);
    wrap(place);
    const double numbers[COLUMNS] = {place[0], place[1], place[2], spot.charge, spot.scale, 1.0 + spot.wall};
    return numbers[column];
}

std::vector<double> KeptCharges::pack() const
{
    std::vector<double> numbers;
    for (const WallPlace &wall : walls_) {
        for (const auto &row : wall.turn) numbers.insert(numbers.end(), row, row + 3);
        numbers.insert(numbers.end(), wall.shift, wall.shift + 3);
    }
    numbers.push_back(size());
    for (const Spot &spot : spots_) {
        numbers.push_back(spot.wall);
        numbers.push_back(spot.bounds_field);
        for (const double *vector : {spot.place, spot.normal, spot.first}) {
            numbers.insert(numbers.end(), vector, vector + 3);
        }
        for (double value : {spot.scale, spot.charge, spot.moved}) numbers.push_back(value);
    }
    return numbers;
}

void KeptCharges::unpack(const double *numbers)
{
    for (WallPlace &wall : walls_) {
        for (int row = 0; row < 3; ++row) std::copy_n(numbers + 3 * row, 3, wall.turn[row]);
        std::copy_n(numbers + 9, 3, wall.shift);
        numbers += WallPlace::SIZE;
    }
    spots_.resize(static_cast<size_t>(*numbers++));
    for (Spot &spot : spots_) {
        spot.wall = static_cast<int>(numbers[0]);
        spot.bounds_field = numbers[1] != 0.0;
        std::copy_n(numbers + 2, 3, spot.place);
        std::copy_n(numbers + 5, 3, spot.normal);
        std::copy_n(numbers + 8, 3, spot.first);
        spot.scale = numbers[11];
        spot.charge = numbers[12];
        spot.moved = numbers[13];
        numbers += NUMBERS;
    }
}
