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
#include "electricField.H"
#include "gasFlow.H"

int main(int argc, char *argv[])
{
    argList::addNote("Gas and electric field of moving grains, for amberfield.");
    argList::addOption("start", "name", "Time to start from, instead of that of controlDict");
    argList::addOption("run", "name", "Run of the DEM process; default: the one that waits");
    argList::noFunctionObjects();
    argList::noBanner();

    #include "setRootCase.H"
    #include "createTime.H"
    #include "startTime.H"
    #include "createMesh.H"

    string run;
    args.readIfPresent("run", run);

    fieldSide demProcess(run);
    autoPtr<electricField> field;
    const word potentialTime
    (
        runTime.findInstance(mesh.dbDir(), "phiE", IOobject::READ_IF_PRESENT)
    );
    if (IOobject("phiE", potentialTime, mesh).typeHeaderOk<volScalarField>(true))
    {
        field.reset(new electricField(mesh, demProcess, true));
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
    gasFlow gas(runTime, mesh, demProcess);

    while (demProcess.wait())
    {
        switch (demProcess.request().question)
        {
            case AmberfieldQuestion_Field:
                if (!field.valid())
                {
                    demProcess.fail
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
        }
    }

    Info<< "The run is over." << nl << endl;

    return 0;
}
