/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "meshDescription.H"
#include "cyclicShifts.H"
#include "fieldSide.H"
#include "fixedGradientFvPatchFields.H"
#include "fixedValueFvPatchFields.H"
#include "globalIndex.H"
#include "processorPolyPatch.H"
#include "slipFvPatchFields.H"
#include "StringStream.H"
#include "symmetryFvPatchFields.H"
#include "symmetryPlaneFvPatchFields.H"
#include "syncTools.H"
#include "zeroGradientFvPatchFields.H"

namespace
{

//- Condition whose potential is a number or a function of time
const char* const uniform = "uniformFixedValue";

//- Whether a patch prescribes the potential
bool isConductor(const Foam::fvPatchScalarField& V)
{
    return V.type() == Foam::fixedValueFvPatchScalarField::typeName
        || V.type() == uniform;
}

//- Whether a patch prescribes the slope
bool isInsulator(const Foam::fvPatchScalarField& V)
{
    return V.type() == Foam::fixedGradientFvPatchScalarField::typeName
        || V.type() == Foam::zeroGradientFvPatchScalarField::typeName
        || V.type() == Foam::slipFvPatchScalarField::typeName
        || V.type() == Foam::symmetryFvPatchScalarField::typeName
        || V.type() == Foam::symmetryPlaneFvPatchScalarField::typeName;
}

//- Prescribed potentials or slopes of a patch
Foam::scalarField prescribed(const Foam::fvPatchScalarField& V)
{
    if (V.type() == uniform)
    {
        // Its entry value is what somebody wrote last
        Foam::tmp<Foam::fvPatchScalarField> now(V.clone());
        now.ref().updateCoeffs();
        return Foam::scalarField(now());
    }
    if (isConductor(V))
    {
        return V;
    }
    if (V.type() == Foam::fixedGradientFvPatchScalarField::typeName)
    {
        return Foam::refCast<const Foam::fixedGradientFvPatchScalarField>(V).gradient();
    }
    return Foam::scalarField(V.size(), Foam::scalar(0));
}

//- Mean square of the corners' distances from a face's centre
Foam::symmTensor spread
(
    const Foam::face& corners,
    const Foam::pointField& points,
    const Foam::vector& centre
)
{
    Foam::symmTensor sum(Foam::Zero);
    for (const Foam::label corner : corners)
    {
        sum += Foam::sqr(points[corner] - centre);
    }
    return sum/Foam::scalar(corners.size());
}

//- Names and types of the patches that all ranks have, each on a line of its
//  own. Patches between ranks come after them.
Foam::string describe(const Foam::polyBoundaryMesh& patches)
{
    Foam::string lines;
    for (const Foam::polyPatch& patch : patches)
    {
        if (!Foam::isA<Foam::processorPolyPatch>(patch))
        {
            lines += patch.name() + ' ' + patch.type() + '\n';
        }
    }
    return lines;
}

//- Why a patch that is neither conductor nor insulator is not possible, and
//  what to do
std::string whyNot(const Foam::fvPatchScalarField& V)
{
    const Foam::word& name = V.patch().name();
    const Foam::word& type = V.patch().patch().type();
    if (type == "empty" || type == "wedge")
    {
        return "patch " + name + " is of type " + type + ": a mesh of one cell's thickness has no"
            " room for grains; make it thicker, and the patch and its condition symmetryPlane";
    }
    return "patch " + name + " of field " + V.internalField().name() + " has the condition "
        + V.type() + "; give it fixedValue, uniformFixedValue, fixedGradient,"
        " zeroGradient, symmetry or cyclic";
}

} // End anonymous namespace


Foam::wordList Foam::meshDescription::farTypes(const volScalarField& V)
{
    wordList types(V.boundaryField().types());
    forAll(types, patchi)
    {
        if (isInsulator(V.boundaryField()[patchi]))
        {
            types[patchi] = fixedGradientFvPatchScalarField::typeName;
        }
        else if (isConductor(V.boundaryField()[patchi]))
        {
            types[patchi] = fixedValueFvPatchScalarField::typeName;
        }
    }
    return types;
}


void Foam::meshDescription::describeCorners(const fvMesh& mesh)
{
    points_ = mesh.points();
    firstFaceCorner_.assign(1, 0);
    forAll(mesh.cells(), celli)
    {
        for (const label facei : mesh.cells()[celli])
        {
            for (const label corner : mesh.faces()[facei])
            {
                faceCorners_.push_back(uint32_t(corner));
            }
            firstFaceCorner_.push_back(uint64_t(faceCorners_.size()));
        }
    }
}


Foam::meshDescription::meshDescription
(
    const volScalarField& V,
    fieldSide& demProcess,
    const bool withCorners,
    const labelList& changing
)
:
    view_(),
    firstCorner_(1, 0),
    patchLines_(describe(V.mesh().boundaryMesh())),
    changing_(changing.begin(), changing.end()),
    centres_(V.mesh().C().primitiveField()),
    volumes_(V.mesh().V())
{
    const fvMesh& mesh = V.mesh();
    const label nInternal = mesh.nInternalFaces();
    const label nBoundary = mesh.nFaces() - nInternal;
    const globalIndex globalCells(mesh.nCells());
    const cyclicShifts shifts(V, demProcess);

    // Beyond coupled faces: the other side's cell
    labelList otherCell(nBoundary, -1);
    vectorField shiftOf(nBoundary, Zero);
    forAll(mesh.boundaryMesh(), patchi)
    {
        const polyPatch& patch = mesh.boundaryMesh()[patchi];
        if (!patch.coupled())
        {
            continue;
        }
        forAll(patch, i)
        {
            const label b = patch.start() + i - nInternal;
            otherCell[b] = globalCells.toGlobal(patch.faceCells()[i]);
            shiftOf[b] = shifts[patchi];
        }
    }
    syncTools::swapBoundaryFaceList(mesh, otherCell);

    // Boundary faces, patch by patch
    labelList boundaryIndex(nBoundary, -1);
    forAll(V.boundaryField(), patchi)
    {
        const fvPatchScalarField& pV = V.boundaryField()[patchi];
        const fvPatch& patch = pV.patch();
        if (pV.coupled())
        {
            continue;
        }
        if (!isConductor(pV) && !isInsulator(pV))
        {
            // No face of the patch, on no rank: nobody sees its condition
            if (returnReduce(mesh.boundaryMesh()[patchi].size(), sumOp<label>()) == 0)
            {
                continue;
            }
            demProcess.refuse(whyNot(pV));
        }
        patches_.append(patchi);
        // Who solves tells potentials that change when they are asked for
        const bool isFixed = !changing.found(patchi);
        const scalarField values(isFixed ? prescribed(pV) : scalarField(pV.size(), Zero));
        const vectorField nf(patch.nf());
        forAll(patch, i)
        {
            boundaryIndex[patch.start() + i - nInternal] = label(boundary_.size());
            const vector& c = patch.Cf()[i];
            const vector& n = nf[i];
            const face& corners = mesh.faces()[patch.start() + i];
            const symmTensor m(spread(corners, mesh.points(), c));

            AmberfieldBoundaryFace described;
            for (direction axis = 0; axis < 3; ++axis)
            {
                described.centre_m[axis] = c[axis];
                described.normal[axis] = n[axis];
            }
            described.area_m2 = patch.magSf()[i];
            described.cell = uint64_t(patch.faceCells()[i]);
            described.patch = uint64_t(patchi);
            described.is_conductor = isConductor(pV) ? 1 : 0;
            described.prescribed = values[i];
            described.spread_xx_m2 = m.xx();
            described.spread_xy_m2 = m.xy();
            described.spread_xz_m2 = m.xz();
            described.spread_yy_m2 = m.yy();
            described.spread_yz_m2 = m.yz();
            described.spread_zz_m2 = m.zz();
            boundary_.push_back(described);
            for (const label corner : corners)
            {
                corners_.append(mesh.points()[corner]);
            }
            firstCorner_.push_back(uint64_t(corners_.size()));
        }
    }
    const globalIndex globalBoundary(label(boundary_.size()));

    // Faces, cell by cell
    label count = 0;
    forAll(mesh.cells(), celli)
    {
        count += mesh.cells()[celli].size();
    }
    normals_.resize(count);
    offsets_.resize(count);
    shifts_.resize(count);
    neighbours_.resize(count);
    firstFace_.assign(1, 0);
    label entry = 0;
    forAll(mesh.cells(), celli)
    {
        for (const label facei : mesh.cells()[celli])
        {
            const bool owner = mesh.faceOwner()[facei] == celli;
            const vector area((owner ? 1.0 : -1.0)*mesh.faceAreas()[facei]);
            const vector n(area/max(mag(area), VSMALL));
            normals_[entry] = n;
            offsets_[entry] = n & mesh.faceCentres()[facei];
            shifts_[entry] = Zero;
            if (facei < nInternal)
            {
                const label other = owner ? mesh.faceNeighbour()[facei] : mesh.faceOwner()[facei];
                neighbours_[entry] = globalCells.toGlobal(other);
            }
            else if (otherCell[facei - nInternal] >= 0)
            {
                neighbours_[entry] = otherCell[facei - nInternal];
                shifts_[entry] = shiftOf[facei - nInternal];
            }
            else
            {
                neighbours_[entry] = -1 - int64_t(boundaryIndex[facei - nInternal]);
            }
            ++entry;
        }
        firstFace_.push_back(uint64_t(entry));
    }

    const boundBox box(mesh.points(), true);
    const vector periods(shifts.periods());
    for (direction axis = 0; axis < 3; ++axis)
    {
        const bool periodic = periods[axis] > 0;
        view_.outline.low_m[axis] = box.min()[axis];
        view_.outline.high_m[axis] = periodic ? box.min()[axis] + periods[axis] : box.max()[axis];
        view_.outline.periodic[axis] = periodic ? 1 : 0;
    }
    view_.outline.first_cell = uint64_t(globalCells.toGlobal(0));
    view_.outline.all_cells = uint64_t(globalCells.size());
    view_.first_boundary = uint64_t(globalBoundary.toGlobal(0));
    view_.cells = uint64_t(mesh.nCells());
    view_.faces = uint64_t(count);
    view_.boundary = uint64_t(boundary_.size());
    view_.corners = uint64_t(corners_.size());
    view_.centres = reinterpret_cast<const double*>(centres_.cdata());
    view_.volumes = volumes_.cdata();
    view_.first_face = firstFace_.data();
    view_.face_normals = reinterpret_cast<const double*>(normals_.cdata());
    view_.face_offsets = offsets_.cdata();
    view_.face_neighbours = neighbours_.data();
    view_.face_shifts = reinterpret_cast<const double*>(shifts_.cdata());
    view_.boundary_faces = boundary_.data();
    view_.first_corner = firstCorner_.data();
    view_.corner_points = reinterpret_cast<const double*>(corners_.cdata());
    view_.patches = patchLines_.c_str();
    view_.changing_patches = changing_.data();
    view_.changing_count = uint64_t(changing_.size());
    if (withCorners)
    {
        describeCorners(mesh);
    }
    view_.point_count = uint64_t(points_.size());
    view_.points = reinterpret_cast<const double*>(points_.cdata());
    view_.first_face_corner = firstFaceCorner_.data();
    view_.face_corners = faceCorners_.data();
}
