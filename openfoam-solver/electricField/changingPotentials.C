/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "changingPotentials.H"
#include "differences.H"
#include "fieldSide.H"
#include "OSspecific.H"
#include "localIOdictionary.H"

#include <limits>

namespace
{

//- Condition of a potential that may be a function of time
const char* const condition = "uniformFixedValue";

//- Its entry
const char* const entryName = "uniformValue";

//- Type of the function that a condition has; none for a plain number
Foam::word typeOf(const Foam::dictionary& entries)
{
    if (entries.isDict(entryName))
    {
        return entries.subDict(entryName).get<Foam::word>("type");
    }
    Foam::ITstream& value = entries.lookup(entryName);
    const Foam::token first(value);
    return first.isWord() ? first.wordToken() : Foam::word::null;
}

//- Whether a type of function stays as it is
bool isConstant(const Foam::word& type)
{
    return type.empty() || type == "constant" || type == "uniform" || type == "nonuniform";
}

//- Folder of a field's file: that of the whole case where it is there, since
//  parts have rounded numbers
Foam::fileName placeOf(const Foam::volScalarField& V)
{
    const Foam::fileName whole(V.time().globalPath()/V.instance());
    return Foam::isFile(whole/V.name()) ? whole : Foam::fileName(V.instance());
}

//- Makes OpenFOAM's errors exceptions while it lives
class asExceptions
{
    const bool before_;
    const bool beforeOfInput_;

public:

    asExceptions()
    :
        before_(Foam::FatalError.throwExceptions()),
        beforeOfInput_(Foam::FatalIOError.throwExceptions())
    {}

    ~asExceptions()
    {
        Foam::FatalError.throwExceptions(before_);
        Foam::FatalIOError.throwExceptions(beforeOfInput_);
    }
};

//- Keeps OpenFOAM's messages back while it lives
class withoutMessages
{
    const int before_;

public:

    withoutMessages()
    :
        before_(Foam::messageStream::level)
    {
        Foam::messageStream::level = 0;
    }

    ~withoutMessages()
    {
        Foam::messageStream::level = before_;
    }
};

} // End anonymous namespace


Foam::changingPotentials::changingPotentials(const volScalarField& V, fieldSide& demProcess)
:
    field_(V.name() + " (file " + V.instance() + '/' + V.name() + ')'),
    demProcess_(demProcess)
{
    DynamicList<label> patches;
    DynamicList<word> names;
    forAll(V.boundaryField(), patchi)
    {
        const polyPatch& patch = V.mesh().boundaryMesh()[patchi];
        const bool mayChange = V.boundaryField()[patchi].type() == condition;
        if (mayChange && returnReduce(patch.size(), sumOp<label>()) > 0)
        {
            patches.append(patchi);
        }
    }
    if (patches.empty())
    {
        return;
    }
    const localIOdictionary file
    (
        IOobject
        (
            V.name(),
            placeOf(V),
            V.mesh(),
            IOobject::MUST_READ,
            IOobject::NO_WRITE,
            false
        ),
        volScalarField::typeName
    );
    DynamicList<label> changing;
    for (const label patchi : patches)
    {
        const polyPatch& patch = V.mesh().boundaryMesh()[patchi];
        const dictionary& entries = entriesOf(file.subDict("boundaryField"), patch);
        const word type(typeOf(entries));
        if (isConstant(type))
        {
            continue;
        }
        if (!isFunctionOfTime(type))
        {
            refuse
            (
                patch.name(),
                "with a " + type + ", whose values differ from place to place; give it a function"
                " of time alone, such as table, sine or csvFile, or the condition fixedValue"
            );
        }
        potentials_.append(functionOfTime(entryName, entries, V));
        changing.append(patchi);
        names.append(patch.name());
    }
    patches_ = changing;
    names_ = names;
}


const Foam::dictionary& Foam::changingPotentials::entriesOf
(
    const dictionary& conditions,
    const polyPatch& patch
)
{
    if (const dictionary* named = conditions.findDict(patch.name(), keyType::LITERAL))
    {
        return *named;
    }
    const dictionary* ofGroup = nullptr;
    for (const entry& each : conditions)
    {
        if (each.isDict() && each.keyword().isLiteral() && patch.inGroups().found(each.keyword()))
        {
            // The last one counts
            ofGroup = &each.dict();
        }
    }
    return ofGroup ? *ofGroup : conditions.subDict(patch.name());
}


void Foam::changingPotentials::refuse(const word& patch, const string& why) const
{
    demProcess_.refuse
    (
        "patch " + patch + " of field " + field_ + " has the condition " + condition + ' ' + why
    );
}


Foam::scalarField Foam::changingPotentials::at(const scalarField& times) const
{
    scalarField values(patches_.size()*times.size(), std::numeric_limits<scalar>::quiet_NaN());
    string why;
    label place = 0;
    forAll(patches_, i)
    {
        if (times.size())
        {
            asExceptions caught;
            try
            {
                values[place] = potentials_[i].value(times[0]);
            }
            catch (const error& error)
            {
                why = error.message();
            }
        }
        if (!why.empty())
        {
            refuse
            (
                names_[i],
                "that has no value at t = " + Foam::name(times[0]) + " s: " + why
              + "; let it reach over the whole run"
            );
        }
        // Nobody may ever get to the times beyond
        withoutMessages quiet;
        asExceptions caught;
        for (label j = 1; j < times.size(); ++j)
        {
            try
            {
                values[place + j] = potentials_[i].value(times[j]);
            }
            catch (const error&)
            {
                continue;
            }
        }
        place += times.size();
    }
    return values;
}
