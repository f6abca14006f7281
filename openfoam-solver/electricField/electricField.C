/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "electricField.H"
#include "differences.H"
#include "fixedGradientFvPatchFields.H"
#include "fvmLaplacian.H"
#include "fvMatrices.H"
#include "surfaceFields.H"

#include <chrono>

namespace
{

//- Share of the charge by which sums over cells may miss neutrality
const Foam::scalar mostMismatch = 0.05;

//- What V starts from over the solution, from which on it is solved for again
const Foam::scalar mostFall = 2;

//- A field that is neither read nor written, and that other fields of the
//  case with its name do not meet
Foam::IOobject own(const char* name, const Foam::fvMesh& mesh)
{
    return Foam::IOobject
    (
        name,
        mesh.time().timeName(),
        mesh,
        Foam::IOobject::NO_READ,
        Foam::IOobject::NO_WRITE,
        false
    );
}

} // End anonymous namespace


Foam::electricField::electricField(const fvMesh& mesh, fieldSide& demProcess, const bool withGas)
:
    mesh_(mesh),
    phiE_(phiE(mesh, demProcess), mesh),
    potentials_(phiE_, demProcess),
    description_(phiE_, demProcess, withGas, potentials_.patches()),
    parts_(mesh, true),
    floating_(floating(parts_, parts_.nRegions(), phiE_)),
    references_(references(parts_, floating_)),
    V_
    (
        own("V", mesh),
        mesh,
        dimensionedScalar("V", phiE_.dimensions(), Zero),
        meshDescription::farTypes(phiE_),
        mesh.boundaryMesh().types()
    ),
    E_(own("E", mesh), -fvc::grad(V_)),
    rho_
    (
        own("rho", mesh),
        mesh,
        dimensionedScalar("rho", dimensionSet(0, -3, 1, 0, 0, 1, 0), Zero)
    ),
    controls_(controls(mesh)),
    nNonOrthogonalCorrectors_
    (
        mesh.solutionDict().subOrEmptyDict("electricField").getOrDefault<label>
        (
            "nNonOrthogonalCorrectors",
            gMax(mag(mesh.nonOrthCorrectionVectors().primitiveField())()) > 0.1 ? 3 : 0
        )
    ),
    demProcess_(demProcess)
{}


void Foam::electricField::show(const word& name)
{
    const auto shown = [&](const char* what)
    {
        return IOobject(name + ':' + what, mesh_.time().timeName(), mesh_);
    };
    shownV_.reset(new volScalarField(shown("V"), mesh_, V_.dimensions()));
    shownE_.reset(new volVectorField(shown("E"), mesh_, E_.dimensions()));
    *shownV_ == V_;
    *shownE_ == E_;
}


bool Foam::electricField::isWanted(const fvMesh& mesh)
{
    // Where OpenFOAM finds a field of the start time: at it, or before
    const word place
    (
        mesh.time().findInstance(mesh.dbDir(), "phiE", IOobject::READ_IF_PRESENT)
    );
    return IOobject("phiE", place, mesh).typeHeaderOk<volScalarField>(true);
}


Foam::IOobject Foam::electricField::phiE(const fvMesh& mesh, fieldSide& demProcess)
{
    if (!isWanted(mesh))
    {
        demProcess.refuse
        (
            "the case has no potential 0/phiE, a volScalarField, at or before the time "
          + mesh.time().timeName() + "; add it"
        );
    }
    return IOobject
    (
        "phiE",
        mesh.time().findInstance(mesh.dbDir(), "phiE", IOobject::MUST_READ),
        mesh,
        IOobject::MUST_READ,
        IOobject::NO_WRITE,
        false
    );
}


Foam::dictionary Foam::electricField::controls(const fvMesh& mesh)
{
    if (mesh.solutionDict().subOrEmptyDict("solvers").found("V"))
    {
        return mesh.solutionDict().subDict("solvers").subDict("V");
    }
    dictionary multigrid;
    multigrid.add("preconditioner", "GAMG");
    multigrid.add("smoother", "DIC");
    multigrid.add("nPreSweeps", 1);
    multigrid.add("nPostSweeps", 1);
    multigrid.add("tolerance", 1e-6);
    multigrid.add("relTol", 0);

    dictionary solver;
    solver.add("solver", "PCG");
    solver.add("preconditioner", multigrid);
    solver.add("maxIter", 1000);
    return solver;
}


void Foam::electricField::answer()
{
    const dimensionedScalar epsilon
    (
        "epsilon", dimensionSet(-1, -3, 4, 0, 0, 2, 0), demProcess_.request().far.permittivity_f_m
    );

    demProcess_.density(rho_.primitiveFieldRef());
    demProcess_.guess(V_.primitiveFieldRef());
    takeBoundary();
    removeMeans(epsilon.value());

    // OpenFOAM's residual is relative to what V starts from: from a much larger one it
    // ends too early
    const scalar before = gMax(mag(V_.primitiveField())());
    const auto begun = std::chrono::steady_clock::now();
    solverPerformance performance(solve(epsilon));
    if (before > mostFall*gMax(mag(V_.primitiveField())()))
    {
        performance = solve(epsilon);
    }

    const std::chrono::duration<scalar> taken = std::chrono::steady_clock::now() - begun;

    if (demProcess_.request().far.wants_e || shownE_)
    {
        E_ = -fvc::grad(V_);
    }
    if (shownE_)
    {
        *shownV_ == V_;
        *shownE_ == E_;
    }

    demProcess_.reply
    (
        V_, E_, performance.nIterations(), performance.finalResidual(), taken.count()
    );
}


Foam::solverPerformance Foam::electricField::solve(const dimensionedScalar& epsilon)
{
    solverPerformance performance;
    for (label corrector = 0; corrector <= nNonOrthogonalCorrectors_; ++corrector)
    {
        fvScalarMatrix VEqn(fvm::laplacian(V_) == -rho_/epsilon);

        VEqn.setReferences(references_, 0, true);

        // The scene's tolerance counts, and nothing else ends a solve
        controls_.set("tolerance", demProcess_.request().far.tolerance);
        controls_.set("relTol", 0);
        performance = VEqn.solve(controls_);
    }
    // OpenFOAM keeps a record of every solve until the time changes, which here it may not
    const_cast<dictionary&>(performanceOf(mesh_)).remove(V_.name());
    return performance;
}


void Foam::electricField::takeBoundary()
{
    const scalarField values(demProcess_.boundary(description_.boundaryFaces()));
    label start = 0;
    for (const label patchi : description_.patches())
    {
        fvPatchScalarField& pV = V_.boundaryFieldRef()[patchi];
        const scalarField onPatch(SubField<scalar>(values, pV.size(), start));
        if (isA<fixedGradientFvPatchScalarField>(pV))
        {
            refCast<fixedGradientFvPatchScalarField>(pV).gradient() = onPatch;
        }
        else
        {
            pV == onPatch;
        }
        start += pV.size();
    }
    // What V starts from is what cells have, whether this process had it or was told
    V_.correctBoundaryConditions();
}


void Foam::electricField::removeMeans(const scalar epsilon)
{
    if (!floating_.found(true))
    {
        return;
    }
    // The DEM process has refused a net charge; finite volumes miss it by a little
    scalarField net(floating_.size(), Zero);
    scalarField volume(floating_.size(), Zero);
    forAll(parts_, celli)
    {
        net[parts_[celli]] += rho_[celli]*mesh_.V()[celli];
        volume[parts_[celli]] += mesh_.V()[celli];
    }
    for (const label patchi : description_.patches())
    {
        const fvPatchScalarField& pV = V_.boundaryField()[patchi];
        const scalarField flux(epsilon*pV.snGrad()*pV.patch().magSf());
        forAll(flux, i)
        {
            net[parts_[pV.patch().faceCells()[i]]] += flux[i];
        }
    }
    combineOfRanks(net, plusEqOp<scalar>());
    combineOfRanks(volume, plusEqOp<scalar>());

    const scalar all = gSum(mag(rho_.primitiveField())*mesh_.V());
    forAll(floating_, parti)
    {
        if
        (
            floating_[parti]
         && !demProcess_.request().far.neutralising_background
         && mag(net[parti]) > mostMismatch*all
        )
        {
            demProcess_.refuse
            (
                "net charge " + Foam::name(net[parti]) + " C of " + Foam::name(all)
              + " C on a mesh no face of which takes it; set neutralising_background = true"
            );
        }
    }
    forAll(parts_, celli)
    {
        if (floating_[parts_[celli]])
        {
            rho_[celli] -= net[parts_[celli]]/volume[parts_[celli]];
        }
    }
}


Foam::boolList Foam::electricField::floating
(
    const labelList& parts,
    const label nParts,
    const volScalarField& V
)
{
    boolList floating(nParts, true);
    for (const fvPatchScalarField& pV : V.boundaryField())
    {
        if (pV.fixesValue())
        {
            for (const label celli : pV.patch().faceCells())
            {
                floating[parts[celli]] = false;
            }
        }
    }
    combineOfRanks(floating, andEqOp<bool>());
    return floating;
}


Foam::labelList Foam::electricField::references
(
    const labelList& parts,
    const boolList& floating
)
{
    // In the first rank that has cells of the part
    labelList rank(floating.size(), labelMax);
    for (const label parti : parts)
    {
        rank[parti] = Pstream::myProcNo();
    }
    combineOfRanks(rank, minEqOp<label>());

    DynamicList<label> cells;
    boolList wanted(floating);
    forAll(parts, celli)
    {
        const label parti = parts[celli];
        if (wanted[parti] && rank[parti] == Pstream::myProcNo())
        {
            cells.append(celli);
            wanted[parti] = false;
        }
    }
    return labelList(cells);
}
