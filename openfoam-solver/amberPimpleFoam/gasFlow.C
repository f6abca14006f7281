/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "gasFlow.H"
#include "constrainPressure.H"
#include "differences.H"
#include "findRefCell.H"
#include "fvc.H"
#include "fvm.H"
#include "gaussLaplacianScheme.H"
#include "linear.H"
#include "meanVelocityForce.H"
#include "zeroGradientFvPatchFields.H"

#include <algorithm>
#include <chrono>

namespace
{

//- Difference of a viscosity from the scene's that is round-off of a case's author
const Foam::scalar sameViscosity = 1e-3;

Foam::IOobject known(const char* name, const Foam::fvMesh& mesh)
{
    return Foam::IOobject
    (
        name, mesh.time().timeName(), mesh, Foam::IOobject::MUST_READ, Foam::IOobject::AUTO_WRITE
    );
}

Foam::IOobject made(const char* name, const Foam::fvMesh& mesh, const bool write)
{
    return Foam::IOobject
    (
        name,
        mesh.time().timeName(),
        mesh,
        Foam::IOobject::NO_READ,
        write ? Foam::IOobject::AUTO_WRITE : Foam::IOobject::NO_WRITE
    );
}

const Foam::dimensionSet dimDrag(Foam::dimless/Foam::dimTime);

typedef std::function<void(Foam::scalar*, Foam::label)> visitor;

template<class Type>
void visitNumbers(Foam::Field<Type>& field, const visitor& visit)
{
    visit
    (
        reinterpret_cast<Foam::scalar*>(field.data()),
        field.size()*Foam::pTraits<Type>::nComponents
    );
}

//- Cells, then patches
template<class Type, template<class> class PatchField, class GeoMesh>
void visitField(Foam::GeometricField<Type, PatchField, GeoMesh>& field, const visitor& visit)
{
    visitNumbers<Type>(field.primitiveFieldRef(), visit);
    forAll(field.boundaryField(), patchi)
    {
        visitNumbers<Type>(field.boundaryFieldRef()[patchi], visit);
    }
}

//- A field as it was a time step before, and whether also the one before that
//  is known, which nothing needs any more but its being there
template<class FieldType>
void visitOld(FieldType& field, const visitor& visit)
{
    Foam::scalar known = field.nOldTimes() > 1 ? 1 : 0;
    visit(&known, 1);
    FieldType& old = field.oldTime();
    if (known > 0)
    {
        old.oldTime();
    }
    // Else it would be taken for a field of a time before
    field.timeIndex() = field.time().timeIndex();
    visitField(old, visit);
}

//- Names of the fields of a type that a case keeps; a field of the step before
//  belongs to its own
template<class FieldType>
Foam::wordList written(const Foam::fvMesh& mesh)
{
    Foam::DynamicList<Foam::word> names;
    for (const Foam::word& name : mesh.sortedNames<FieldType>())
    {
        const FieldType& field = mesh.lookupObject<FieldType>(name);
        if (field.writeOpt() == Foam::IOobject::AUTO_WRITE && !name.ends_with("_0"))
        {
            names.append(name);
        }
    }
    return Foam::wordList(names);
}

template<class FieldType>
void visitNamed
(
    const Foam::wordList& names,
    Foam::fvMesh& mesh,
    const bool isLongMemory,
    const visitor& visit
)
{
    for (const Foam::word& name : names)
    {
        FieldType& field = mesh.lookupObjectRef<FieldType>(name);
        visitField(field, visit);
        if (isLongMemory)
        {
            visitOld(field, visit);
        }
    }
}

//- Whether any term has the scheme backward, which knows two steps before
bool hasBackward(const Foam::fvMesh& mesh)
{
    for (const Foam::entry& term : schemesOf(mesh).subOrEmptyDict("ddtSchemes"))
    {
        for (const Foam::token& word : term.stream())
        {
            if (word.isWord() && word.wordToken() == "backward")
            {
                return true;
            }
        }
    }
    return false;
}

//- The pressure gradient of a meanVelocityForce, which it keeps to itself
class meanForce
:
    public Foam::fv::meanVelocityForce
{
    using Foam::fv::meanVelocityForce::meanVelocityForce;

public:

    static void visit(Foam::fv::meanVelocityForce& force, const visitor& visit)
    {
        visit(&(force.*(&meanForce::gradP0_)), 1);
        visit(&(force.*(&meanForce::dGradP_)), 1);
    }
};

//- Mean of two cells at their face, each weighted by its own distance from it:
//  that of things in series, one behind the other
template<class Type>
Foam::tmp<Foam::GeometricField<Type, Foam::fvsPatchField, Foam::surfaceMesh>> inSeries
(
    const Foam::GeometricField<Type, Foam::fvPatchField, Foam::volMesh>& field
)
{
    return Foam::surfaceInterpolationScheme<Type>::interpolate
    (
        field, 1 - field.mesh().surfaceInterpolation::weights()
    );
}

} // End anonymous namespace


Foam::gasFlow::gasFlow
(
    runClock& time,
    fvMesh& mesh,
    fieldSide& demProcess,
    caseFunctions& functions
)
:
    time_(time),
    mesh_(mesh),
    demProcess_(demProcess),
    functions_(functions),
    caseTime_(time.value()),
    p_(known("p", mesh), mesh),
    U_(known("U", mesh), mesh),
    alpha_
    (
        made("alpha", mesh, true),
        mesh,
        dimensionedScalar("alpha", dimless, 1),
        zeroGradientFvPatchScalarField::typeName
    ),
    phi_(made("phi", mesh, false), fvc::flux(U_)),
    alphaPhi_(made("alphaPhi", mesh, false), phi_),
    transport_(U_, phi_),
    turbulence_(turbulenceType::New(alpha_, U_, alphaPhi_, phi_, transport_)),
    options_(fv::options::New(mesh)),
    drag_
    (
        made("drag", mesh, false),
        mesh,
        dimensionedScalar("drag", dimDrag, Zero),
        zeroGradientFvPatchScalarField::typeName
    ),
    source_
    (
        made("source", mesh, false),
        mesh,
        dimensionedVector("source", dimAcceleration, Zero),
        zeroGradientFvPatchVectorField::typeName
    ),
    pimple_(mesh),
    slope_(p_, U_),
    nNonOrthogonalCorrectors_
    (
        pimple_.dict().getOrDefault<label>
        (
            "nNonOrthogonalCorrectors", slope_.isOblique() ? 1 : 0
        )
    ),
    pRefCell_(0),
    pRefValue_(0),
    scalars_(written<volScalarField>(mesh)),
    vectors_(written<volVectorField>(mesh)),
    tensors_(written<volSymmTensorField>(mesh)),
    isLongMemory_(hasBackward(mesh)),
    isTimeKnown_(false),
    begun_(false),
    isAdvised_(false),
    iterations_(0)
{
    setRefCell(p_, pimple_.dict(), pRefCell_, pRefValue_);
    mesh_.setFluxRequired(p_.name());

    // Entries that cases of other solvers lack are missed before anything is computed
    mesh_.divScheme("div(alphaPhi,U)");
    for (const word& name : {p_.name(), U_.name()})
    {
        mesh_.solver(name + "Final");
    }
}


Foam::scalar Foam::gasFlow::mostCourant() const
{
    const dictionary& control = time_.controlDict();
    const bool isControlled = control.getOrDefault("adjustTimeStep", false);
    return pimple_.dict().getOrDefault<scalar>
    (
        "maxCo", isControlled ? control.getOrDefault<scalar>("maxCo", 1) : 1
    );
}


void Foam::gasFlow::checkGas() const
{
    const AmberfieldFlowQuestion& gas = demProcess_.request().flow;
    const scalar ours = gMax(transport_.nu()().primitiveField());
    const scalar theirs = gas.viscosity_pa_s/gas.density_kg_m3;
    if (mag(ours - theirs) > sameViscosity*theirs)
    {
        demProcess_.refuse
        (
            "nu of constant/transportProperties is " + Foam::name(ours)
          + " m2/s, the scene's gas.viscosity_Pa_s over gas.density_kg_m3 is "
          + Foam::name(theirs) + "; make them agree"
        );
    }
}


void Foam::gasFlow::takeGrains(scalarField& voidFraction, const scalar density)
{
    demProcess_.grains
    (
        voidFraction, drag_.primitiveFieldRef(), source_.primitiveFieldRef()
    );
    drag_.primitiveFieldRef() /= density;
    source_.primitiveFieldRef() /= density;
    drag_.correctBoundaryConditions();
    source_.correctBoundaryConditions();
}


void Foam::gasFlow::answer()
{
    const AmberfieldFlowQuestion question = demProcess_.request().flow;
    const auto begun = std::chrono::steady_clock::now();
    scalar residual = 0;
    scalar courant = 0;
    label steps = 0;
    iterations_ = 0;
    checkGas();
    if (!isTimeKnown_)
    {
        isTimeKnown_ = true;
        time_.begin(question.time_s);
    }
    functions_.begin();

    scalarField voidFraction(mesh_.nCells());
    takeGrains(voidFraction, question.density_kg_m3);

    if (!begun_)
    {
        // Grains that were there before: no gas flows because of them
        alpha_.primitiveFieldRef() = voidFraction;
        alpha_.correctBoundaryConditions();
        alphaPhi_ = linearInterpolate(alpha_)*phi_;
        begun_ = true;
    }
    if (question.interval_s > 0)
    {
        const scalarField through(fvc::surfaceSum(mag(phi_))().primitiveField());
        courant = 0.5*question.interval_s*gMax(scalarField(through/mesh_.V().field()));
        const scalar most = mostCourant();
        steps = max(label(1), label(std::ceil(courant/most)));
        courant /= steps;
        const scalarField before(alpha_.primitiveField());

        time_.setDeltaT(question.interval_s/steps, false);
        for (label i = 1; i <= steps; ++i)
        {
            ++time_;
            // Kept before alpha changes
            alpha_.oldTime();
            alphaPhi_.oldTime();
            const scalar share = scalar(i)/steps;
            alpha_.primitiveFieldRef() = (1 - share)*before + share*voidFraction;
            alpha_.correctBoundaryConditions();
            step(question.model_b == 1);
            residual = max(residual, missing());
            time_.write();
            functions_.execute();
        }
        Info<< "Gas at " << time_.value() << " s: steps " << steps << ", Courant number " << courant
            << ", void fraction " << gMin(voidFraction) << " to " << gMax(voidFraction)
            << ", drag " << gMin(drag_.primitiveField()) << " to " << gMax(drag_.primitiveField())
            << " 1/s, continuity " << residual << endl;
    }
    const std::chrono::duration<scalar> taken = std::chrono::steady_clock::now() - begun;

    AmberfieldFlowAnswer outcome;
    outcome.iterations = uint64_t(iterations_);
    outcome.residual = residual;
    outcome.seconds = taken.count();
    outcome.steps = uint64_t(steps);
    outcome.courant = courant;
    answer(question.density_kg_m3, outcome);
}


Foam::string Foam::gasFlow::advice() const
{
    string advice;
    forAll(U_.boundaryField(), patchi)
    {
        const fvPatchVectorField& pU = U_.boundaryField()[patchi];
        if (pU.type() == "flowRateInletVelocity")
        {
            advice += "the flow rate of patch " + pU.patch().name() + " (flowRateInletVelocity) is that"
                " between grains: where grains are at the patch, less gas comes in; give"
                " interstitialInletVelocity the superficial velocity. ";
        }
    }
    if (caseTime_ != time_.startTime().value())
    {
        advice += "the flow starts from the fields that the case has at the time " + Foam::name(caseTime_)
          + " s (startFrom and startTime of system/controlDict). ";
    }
    if (pimple_.dict().getOrDefault("consistent", false))
    {
        advice += "PIMPLE's entry consistent is not used. ";
    }
    word scheme;
    mesh_.gradScheme("grad(U)") >> scheme;
    if (scheme == "Gauss" && slope_.isOblique())
    {
        advice += "the mesh is not orthogonal, and gradSchemes has Gauss for grad(U); give it"
            " leastSquares, which is right on any cells (the pressure's gradient is so already). ";
    }
    return advice;
}


void Foam::gasFlow::step(const bool modelB)
{
    while (pimple_.loop())
    {
        fvVectorMatrix UEqn
        (
            fvm::ddt(alpha_, U_) + fvm::div(alphaPhi_, U_)
          - fvm::Sp(fvc::ddt(alpha_) + fvc::div(alphaPhi_), U_)
          + turbulence_->divDevRhoReff(U_)
          + fvm::Sp(drag_, U_)
         ==
            source_ + options_(alpha_, U_)
        );
        UEqn.relax();
        options_.constrain(UEqn);

        if (pimple_.momentumPredictor())
        {
            if (modelB)
            {
                solve(UEqn == -slope_());
            }
            else
            {
                solve(UEqn == -alpha_*slope_());
            }
            options_.correct(U_);
        }
        while (pimple_.correct())
        {
            correctPressure(UEqn, modelB);
        }
        if (pimple_.turbCorr())
        {
            transport_.correct();
            turbulence_->correct();
        }
    }
}


Foam::tmp<Foam::surfaceScalarField> Foam::gasFlow::kept() const
{
    // The flux that was there before goes on, not the mean of the cells' velocities
    const dimensionedScalar perTime("perTime", dimless/dimTime, 1/time_.deltaTValue());
    tmp<surfaceScalarField> kept
    (
        perTime
       *(
            alphaPhi_.oldTime()
          - (
                linearInterpolate(volVectorField(alpha_.oldTime()*U_.oldTime()))
              & mesh_.Sf()
            )
        )
    );
    surfaceScalarField::Boundary& patches = kept.ref().boundaryFieldRef();
    forAll(patches, patchi)
    {
        if (!patches[patchi].coupled())
        {
            patches[patchi] = Zero;
        }
    }
    return kept;
}


void Foam::gasFlow::correctPressure(const fvVectorMatrix& UEqn, const bool modelB)
{
    const dimensionedScalar one("one", dimless, 1);
    // Share of the pressure's gradient that acts on the gas, at cells and faces
    const volScalarField acts("acts", modelB ? one + 0*alpha_ : 1*alpha_);
    const surfaceScalarField alphaf("alphaf", linearInterpolate(alpha_));
    const surfaceScalarField actsf("actsf", linearInterpolate(acts));

    // What drag takes off p along a superficial flux: -grad(p) = R alpha U + ...
    const volScalarField resistance("resistance", drag_/(acts*alpha_));
    const surfaceScalarField Kf("Kf", actsf*alphaf*inSeries(resistance));
    const surfaceScalarField D
    (
        "D", linearInterpolate(volScalarField(UEqn.A() - drag_)) + Kf
    );
    const surfaceScalarField rAUpf("rAUpf", actsf/D);

    // Without the grains: their drag and source are at the face already
    const volVectorField H(UEqn.H() - source_);
    surfaceScalarField phiHbyA
    (
        "phiHbyA",
        (
            (linearInterpolate(H) & mesh_.Sf()) + kept()
          + actsf*(inSeries(volVectorField(source_/acts)) & mesh_.Sf())
        )/D
    );
    forAll(U_.boundaryField(), patchi)
    {
        const fvPatchVectorField& pU = U_.boundaryField()[patchi];
        const bool isMirror = polyPatch::constraintType(pU.patch().type());
        if (!pU.coupled() && (isMirror || !pU.assignable()))
        {
            phiHbyA.boundaryFieldRef()[patchi] = pU & mesh_.Sf().boundaryField()[patchi];
        }
    }
    constrainPressure(p_, U_, phiHbyA, rAUpf);

    const surfaceScalarField conducts("conducts", alphaf*rAUpf);
    for (label i = 0; i <= nNonOrthogonalCorrectors_; ++i)
    {
        const surfaceScalarField oblique(conducts*slope_.oblique());
        fvScalarMatrix pEqn
        (
            fv::gaussLaplacianScheme<scalar, scalar>::fvmLaplacianUncorrected
            (
                conducts*mesh_.magSf(), mesh_.nonOrthDeltaCoeffs(), p_
            )
         ==
            fvc::ddt(alpha_) + fvc::div(alphaf*phiHbyA) - fvc::div(oblique)
        );
        pEqn.setReference(pRefCell_, pRefValue_);
        iterations_ += pEqn.solve(mesh_.solver(p_.select(pimple_.finalInnerIter()))).nIterations();

        if (i == nNonOrthogonalCorrectors_)
        {
            alphaPhi_ = alphaf*phiHbyA - pEqn.flux() - oblique;
        }
        else
        {
            slope_.update(resistance, acts, drag_, source_, phi_);
        }
    }
    phi_ = alphaPhi_/alphaf;
    p_.relax();
    slope_.update(resistance, acts, drag_, source_, phi_);
    U_ = (UEqn.H() - acts*slope_())/UEqn.A();
    U_.correctBoundaryConditions();
    options_.correct(U_);
}


Foam::scalar Foam::gasFlow::missing() const
{
    const scalarField missed
    (
        (fvc::ddt(alpha_) + fvc::div(alphaPhi_))().primitiveField()*time_.deltaTValue()
    );
    return sqrt(gSum(sqr(missed)*mesh_.V())/gSum(mesh_.V()));
}


void Foam::gasFlow::answer(const scalar density, const AmberfieldFlowAnswer& outcome)
{
    const AmberfieldFlowQuestion& question = demProcess_.request().flow;
    const vectorField gradient(density*slope_().primitiveField());
    vectorField viscous;
    vectorField vorticity;
    if (question.viscous_force == 1)
    {
        const volScalarField muEff(density*turbulence_->nuEff());
        viscous =
        (
            fvc::laplacian(muEff, U_) + fvc::div(muEff*dev2(T(fvc::grad(U_))))
        )().primitiveField();
    }
    if (question.vorticity == 1)
    {
        vorticity = fvc::curl(U_)().primitiveField();
    }

    const auto numbers = [](const vectorField& field)
    {
        return field.empty() ? nullptr : reinterpret_cast<const scalar*>(field.cdata());
    };
    AmberfieldFlow flow;
    flow.cells = uint64_t(mesh_.nCells());
    flow.velocity = numbers(U_.primitiveField());
    flow.pressure_gradient = numbers(gradient);
    flow.viscous_force = numbers(viscous);
    flow.vorticity = numbers(vorticity);
    flow.answer = outcome;
    // Said once, by one rank
    const string words(isAdvised_ || !Pstream::master() ? string() : advice());
    isAdvised_ = true;
    flow.advice = words.empty() ? nullptr : words.c_str();
    demProcess_.reply(flow);
}


void Foam::gasFlow::visitState(const std::function<void(scalar*, label)>& visit)
{
    visitNamed<volScalarField>(scalars_, mesh_, isLongMemory_, visit);
    visitNamed<volVectorField>(vectors_, mesh_, isLongMemory_, visit);
    visitNamed<volSymmTensorField>(tensors_, mesh_, isLongMemory_, visit);
    visitField(phi_, visit);
    visitField(alphaPhi_, visit);
    visitField(slope_.values(), visit);
    for (fv::option& option : static_cast<fv::optionList&>(options_))
    {
        if (isA<fv::meanVelocityForce>(option))
        {
            meanForce::visit(refCast<fv::meanVelocityForce>(option), visit);
        }
    }
}


void Foam::gasFlow::save()
{
    DynamicList<scalar> state;
    state.append(begun_ ? 1 : 0);
    state.append(time_.numbers());
    visitState
    (
        [&state](scalar* numbers, const label count)
        {
            state.append(SubList<scalar>(UList<scalar>(numbers, count), count));
        }
    );
    demProcess_.replyState(scalarField(state));
}


void Foam::gasFlow::restore()
{
    label size = 1 + runClock::size;
    visitState([&size](scalar*, const label count) { size += count; });
    scalarField state(size);
    demProcess_.takeState(state);

    begun_ = state[0] == 1;
    isTimeKnown_ = true;
    time_.take(SubField<scalar>(state, runClock::size, 1));
    label place = 1 + runClock::size;
    visitState
    (
        [&state, &place](scalar* numbers, const label count)
        {
            std::copy_n(state.cdata() + place, count, numbers);
            place += count;
        }
    );
    demProcess_.replyState(scalarField());
}
