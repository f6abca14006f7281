/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later

Application
    amberPimpleFoam

Description
    The flow of a gas between grains that a DEM process moves, and the smooth
    part of their electric field where the case has a potential phiE, on one
    mesh.

Usage
    amberPimpleFoam -case CASE [-run RUN]

\*---------------------------------------------------------------------------*/

#include "fvCFD.H"
#include "caseChecks.H"
#include "caseFunctions.H"
#include "electricField.H"
#include "gasFlow.H"

namespace
{

void answerAll(const Foam::argList& args, Foam::fieldSide& demProcess)
{
    runClock runTime(args);
    caseChecks::checkMesh(runTime, demProcess);
    #include "createMesh.H"
    caseChecks::checkGas(mesh, demProcess);

    caseFunctions functions(runTime, demProcess);
    gasFlow gas(runTime, mesh, demProcess, functions);

    autoPtr<electricField> field;
    if (electricField::isWanted(mesh))
    {
        field.reset(new electricField(mesh, demProcess, true));
        if (functions.any())
        {
            field->show("electricField");
        }
        field->sendMesh();
    }
    else
    {
        const volScalarField noPotential
        (
            IOobject("noPotential", runTime.timeName(), mesh),
            mesh,
            dimensionedScalar(dimless, Zero),
            zeroGradientFvPatchScalarField::typeName
        );
        demProcess.sendMesh(meshDescription(noPotential, demProcess, true));
    }

    while (demProcess.wait())
    {
        switch (demProcess.request().question)
        {
            case AmberfieldQuestion_Field:
                if (!field)
                {
                    demProcess.refuse
                    (
                        "the scene has an electric field, the case no potential 0/phiE; add it"
                    );
                }
                field->answer();
                break;

            case AmberfieldQuestion_Flow:
                gas.answer();
                break;

            case AmberfieldQuestion_State:
                gas.save();
                break;

            case AmberfieldQuestion_Restore:
                gas.restore();
                break;

            case AmberfieldQuestion_Potentials:
                // Answered while it waits
                break;
        }
    }
    functions.end();

    Info<< "The run is over." << nl << endl;
}

} // End anonymous namespace


int main(int argc, char *argv[])
{
    argList::addNote("Gas and electric field of moving grains, for amberfield.");
    argList::addOption("start", "name", "Time to start from, instead of that of controlDict");
    argList::addOption("run", "name", "Run of the DEM process; default: the one that waits");
    argList::noBanner();

    #include "setRootCase.H"

    string run;
    args.readIfPresent("run", run);
    fieldSide demProcess(run);

    return demProcess.lead([&] { answerAll(args, demProcess); });
}
