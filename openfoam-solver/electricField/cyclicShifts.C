/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "cyclicShifts.H"
#include "cyclicPolyPatch.H"
#include "differences.H"
#include "processorCyclicPolyPatch.H"
#include "processorPolyPatch.H"
#include "syncTools.H"

namespace
{

//- Difference of shifts, and distance, that is round-off of a mesh's author,
//  over the size of the faces there
const Foam::scalar same = 1e-2;

//- Cosine of a face's normal with an axis from which on it stands across it
const Foam::scalar across = 0.999;

const char* const axes[3] = {"x", "y", "z"};

} // End anonymous namespace


Foam::cyclicShifts::cyclicShifts(const volScalarField& V, fieldSide& demProcess)
:
    mesh_(V.mesh()),
    demProcess_(demProcess),
    shifts_(mesh_.boundaryMesh().nNonProcessor(), Zero),
    sizes_(shifts_.size(), Zero)
{
    checkKinds(V);
    measure();
}


Foam::label Foam::cyclicShifts::cyclicOf(const label patchi) const
{
    const polyPatch& patch = mesh_.boundaryMesh()[patchi];
    if (isA<processorCyclicPolyPatch>(patch))
    {
        return refCast<const processorCyclicPolyPatch>(patch).referPatchID();
    }
    return isA<cyclicPolyPatch>(patch) ? patchi : -1;
}


void Foam::cyclicShifts::checkKinds(const volScalarField& V) const
{
    forAll(shifts_, patchi)
    {
        const polyPatch& patch = mesh_.boundaryMesh()[patchi];
        const word& condition = V.boundaryField()[patchi].type();
        if (!isA<coupledPolyPatch>(patch))
        {
            continue;
        }
        if (patch.type() != cyclicPolyPatch::typeName)
        {
            demProcess_.refuse
            (
                "patch " + patch.name() + " is of type " + patch.type() + "; only patches of type"
              + " cyclic are possible, whose faces match one by one: make the mesh alike on both"
              + " sides, and this patch and its neighbour cyclic"
            );
        }
        if (condition != cyclicPolyPatch::typeName)
        {
            demProcess_.refuse
            (
                "patch " + patch.name() + " of field " + V.name() + " has the condition "
              + condition + ", but the potential cannot jump; give it cyclic"
            );
        }
    }
}


void Foam::cyclicShifts::measure()
{
    const polyBoundaryMesh& patches = mesh_.boundaryMesh();
    const label nInternal = mesh_.nInternalFaces();
    pointField beyond(mesh_.nFaces() - nInternal, Zero);
    for (const polyPatch& patch : patches)
    {
        if (patch.coupled())
        {
            SubList<point>(beyond, patch.size(), patch.start() - nInternal) = patch.faceCentres();
        }
    }
    // One by one: vectors would be turned on their way
    for (direction axis = 0; axis < 3; ++axis)
    {
        scalarField x(beyond.component(axis));
        syncTools::swapBoundaryFaceList(mesh_, x);
        beyond.replace(axis, x);
    }

    vectorField least(shifts_.size(), vector::max);
    vectorField most(shifts_.size(), vector::min);
    forAll(patches, patchi)
    {
        const polyPatch& patch = patches[patchi];
        const label cyclici = cyclicOf(patchi);
        if (cyclici < 0)
        {
            continue;
        }
        forAll(patch, i)
        {
            const vector shift(patch.faceCentres()[i] - beyond[patch.start() + i - nInternal]);
            least[cyclici] = min(least[cyclici], shift);
            most[cyclici] = max(most[cyclici], shift);
            sizes_[cyclici] = max(sizes_[cyclici], sqrt(mag(patch.faceAreas()[i])));
        }
    }
    combineOfRanks(least, minEqOp<vector>());
    combineOfRanks(most, maxEqOp<vector>());
    combineOfRanks(sizes_, maxEqOp<scalar>());

    forAll(shifts_, patchi)
    {
        if (sizes_[patchi] <= 0)
        {
            continue;
        }
        const word& name = patches[patchi].name();
        if (cmptMax(most[patchi] - least[patchi]) > same*sizes_[patchi])
        {
            demProcess_.refuse
            (
                "patch " + name + " turns what crosses it; only cyclic patches that move it along"
              + " x, y or z are possible: make the whole ring, or give this patch and its"
              + " neighbour another type"
            );
        }
        const vector shift(0.5*(least[patchi] + most[patchi]));
        label along = 0;
        for (direction axis = 0; axis < 3; ++axis)
        {
            if (mag(shift[axis]) > same*sizes_[patchi])
            {
                shifts_[patchi][axis] = shift[axis];
                ++along;
            }
        }
        if (along > 1)
        {
            demProcess_.refuse
            (
                "patch " + name + " moves what crosses it by (" + Foam::name(shift.x()) + " "
              + Foam::name(shift.y()) + " " + Foam::name(shift.z()) + ") m, along no axis; turn the"
              + " mesh until its cyclic patches stand opposite each other along x, y or z"
            );
        }
    }
}


Foam::scalar Foam::cyclicShifts::period(const direction axis, const boundBox& box) const
{
    const polyBoundaryMesh& patches = mesh_.boundaryMesh();
    label first = -1;
    forAll(shifts_, patchi)
    {
        const scalar length = mag(shifts_[patchi][axis]);
        if (length <= 0)
        {
            continue;
        }
        if (first < 0)
        {
            first = patchi;
        }
        const scalar known = mag(shifts_[first][axis]);
        if (mag(length - known) > same*sizes_[patchi])
        {
            demProcess_.refuse
            (
                "patch " + patches[first].name() + " is " + Foam::name(known)
              + " m from its neighbour along " + axes[axis] + ", patch " + patches[patchi].name()
              + " " + Foam::name(length) + " m; there can be one period along an axis: make them"
              + " agree"
            );
        }
    }
    if (first < 0)
    {
        return 0;
    }
    const scalar found = mag(shifts_[first][axis]);
    const scalar extent = box.max()[axis] - box.min()[axis];
    if (mag(extent - found) > same*sizes_[first])
    {
        demProcess_.refuse
        (
            "patch " + patches[first].name() + " is " + Foam::name(found)
          + " m from its neighbour along " + axes[axis] + ", but the mesh is "
          + Foam::name(extent) + " m long there; cyclic patches must be flat, stand across the"
          + " axis, and have the whole mesh between them"
        );
    }
    return found;
}


void Foam::cyclicShifts::checkEnds(const direction axis, const boundBox& box) const
{
    forAll(shifts_, patchi)
    {
        const polyPatch& patch = mesh_.boundaryMesh()[patchi];
        if (patch.coupled())
        {
            continue;
        }
        bool atEnd = false;
        forAll(patch, i)
        {
            const vector& area = patch.faceAreas()[i];
            const scalar x = patch.faceCentres()[i][axis];
            const scalar distance = min(mag(x - box.min()[axis]), mag(x - box.max()[axis]));
            atEnd = atEnd
             || (mag(area[axis]) > across*mag(area) && distance < same*sqrt(mag(area)));
        }
        if (returnReduce(atEnd, orOp<bool>()))
        {
            demProcess_.refuse
            (
                "patch " + patch.name() + " stands beside cyclic patches at an end of the mesh"
              + " along " + axes[axis] + "; one end cannot be half cyclic and half wall: make it"
              + " all cyclic or all wall, or move the wall into the mesh"
            );
        }
    }
}


Foam::vector Foam::cyclicShifts::periods() const
{
    const boundBox box(mesh_.points(), true);
    vector found(Zero);
    for (direction axis = 0; axis < 3; ++axis)
    {
        found[axis] = period(axis, box);
        if (found[axis] > 0)
        {
            checkEnds(axis, box);
        }
    }
    return found;
}
