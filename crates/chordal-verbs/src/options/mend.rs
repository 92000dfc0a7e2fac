//! `MendOptions`: the options of `mend`, one for each repair.
use super::values::{count, length, word};
use super::{OptionRow, OptionSection, OptionTable, OptionValues, store, store_some};
use crate::{Duplicates, HoleSelection, MendSpec, NestedShells, WeldTolerance};
use chordal_io::Format;

/// A request for repairs.
#[derive(Clone, Debug, Default)]
pub struct MendOptions {
    repairs: MendSpec,
    is_for_all: bool,
    to: Option<Format>,
}

impl MendOptions {
    /// The format of the result, if it is named.
    #[must_use]
    pub fn to(&self) -> Option<Format> {
        self.to
    }

    /// The repairs: those that were named, and all others without tolerance if all were asked for.
    #[must_use]
    pub fn spec(&self) -> MendSpec {
        // A repair by name comes first, since it may have a length or a number.
        let named = &self.repairs;
        let others = if self.is_for_all { MendSpec::ALL } else { MendSpec::default() };
        MendSpec {
            weld: named.weld.or(others.weld),
            drop_duplicates: named.drop_duplicates.or(others.drop_duplicates),
            drop_degenerate: named.drop_degenerate || others.drop_degenerate,
            resolve_t_junctions: named.resolve_t_junctions.or(others.resolve_t_junctions),
            split_non_manifold: named.split_non_manifold || others.split_non_manifold,
            orient: named.orient || others.orient,
            nested: named.nested,
            fill_holes: named.fill_holes.or(others.fill_holes),
            drop_unused: named.drop_unused || others.drop_unused,
        }
    }
}

/// The group of all repairs, of which one is needed.
const REPAIRS: &[&str] = &["repairs"];
/// The repairs that turn faces are in a second one.
const ORIENTING: &[&str] = &["repairs", "orienting"];

const DUPLICATES: OptionValues =
    OptionValues::Words(&[("any", "Whatever their winding"), ("alike", "Only with the same winding")]);
const SHELLS: OptionValues = OptionValues::Words(&[
    ("keep", "As they are wound, compared to the piece around them"),
    ("cavity", "Inwards within an odd number of others, outwards within an even number"),
]);

/// A length, or an empty text for coordinates that are equal.
fn closeness(text: &str) -> Result<WeldTolerance, String> {
    if text.is_empty() { Ok(WeldTolerance::Exact) } else { length(text).map(WeldTolerance::Within) }
}

impl OptionTable for MendOptions {
    const REQUIRED_GROUP: Option<&'static str> = Some("repairs");

    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::output_format(|options, text| store_some(&mut options.to, text.parse())),
        OptionRow::<Self>::flag(
            "all",
            "All repairs below, without tolerance and with all holes unless other options say more: what a 3D print needs",
            |options, _| {
                options.is_for_all = true;
                Ok(())
            },
        )
        .in_groups(ORIENTING)
        .under(OptionSection::Repairs),
        OptionRow::<Self>::new(
            "weld",
            (OptionValues::Length, "LENGTH"),
            "Merge vertices with the same coordinates, or within a length of each other",
            |options, text| store_some(&mut options.repairs.weld, closeness(text)),
        )
        .or_bare("")
        .in_groups(REPAIRS)
        .under(OptionSection::Repairs),
        OptionRow::<Self>::new(
            "drop-duplicates",
            (DUPLICATES, "WHICH"),
            "Drop faces that repeat an earlier one, whatever their winding, or only those wound alike",
            |options, text| {
                let words = [("any", Duplicates::EitherWay), ("alike", Duplicates::SameWay)];
                store_some(&mut options.repairs.drop_duplicates, word(text, &words))
            },
        )
        .or_bare("any")
        .in_groups(REPAIRS)
        .under(OptionSection::Repairs),
        OptionRow::<Self>::flag("drop-degenerate", "Drop faces without area, without opening cracks", |options, _| {
            options.repairs.drop_degenerate = true;
            Ok(())
        })
        .in_groups(REPAIRS)
        .under(OptionSection::Repairs),
        OptionRow::<Self>::new(
            "resolve-t-junctions",
            (OptionValues::Length, "LENGTH"),
            "Split faces where a vertex lies on their edge: exactly, or within a length",
            |options, text| store_some(&mut options.repairs.resolve_t_junctions, closeness(text)),
        )
        .or_bare("")
        .in_groups(REPAIRS)
        .under(OptionSection::Repairs),
        OptionRow::<Self>::flag(
            "split-nonmanifold",
            "Split the surface at edges with three or more faces and at vertices with several fans",
            |options, _| {
                options.repairs.split_non_manifold = true;
                Ok(())
            },
        )
        .in_groups(REPAIRS)
        .under(OptionSection::Repairs),
        OptionRow::<Self>::flag(
            "orient",
            "Wind faces alike and closed pieces outwards; pieces within others turn with them, unless {nested} says otherwise",
            |options, _| {
                options.repairs.orient = true;
                Ok(())
            },
        )
        .in_groups(ORIENTING)
        .under(OptionSection::Repairs),
        OptionRow::<Self>::new(
            "nested",
            (SHELLS, "WHICH"),
            "For closed pieces within others that face the same way: keep them solid, as their winding says, or make each a \
             cavity",
            |options, text| {
                let words = [("keep", NestedShells::Keep), ("cavity", NestedShells::Cavity)];
                store(&mut options.repairs.nested, word(text, &words))
            },
        )
        .default("keep")
        .needs("orienting")
        .under(OptionSection::Repairs),
        OptionRow::<Self>::new(
            "fill-holes",
            (OptionValues::Count, "EDGES"),
            "Fill holes: all, or those with at most EDGES edges; with {orient} faces are wound once more afterwards",
            |options, text| {
                let holes =
                    if text.is_empty() { Ok(HoleSelection::All) } else { edges(text).map(HoleSelection::UpTo) };
                store_some(&mut options.repairs.fill_holes, holes)
            },
        )
        .or_bare("")
        .in_groups(REPAIRS)
        .under(OptionSection::Repairs),
        OptionRow::<Self>::flag("drop-unused", "Drop vertices that no face uses", |options, _| {
            options.repairs.drop_unused = true;
            Ok(())
        })
        .in_groups(REPAIRS)
        .under(OptionSection::Repairs),
    ];
}

fn edges(text: &str) -> Result<usize, String> {
    usize::try_from(count(text)?).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::budget::advice::Cure;

    #[test]
    fn every_cure_is_an_option() {
        for cure in Cure::ALL {
            assert!(MendOptions::row(cure.name()).is_some(), "{}", cure.name());
        }
    }

    #[test]
    fn what_is_named_counts_beside_all() {
        let mut options = MendOptions::default();
        for (name, text) in [("all", ""), ("weld", "0.1"), ("drop-duplicates", "alike"), ("fill-holes", "20")]
        {
            options.set(name, text).expect("a value of its option");
        }
        let spec = options.spec();
        assert!(matches!(spec.weld, Some(WeldTolerance::Within(_))));
        assert_eq!(spec.drop_duplicates, Some(Duplicates::SameWay));
        assert_eq!(spec.fill_holes, Some(HoleSelection::UpTo(20)));
        assert!(spec.orient && spec.drop_unused && spec.resolve_t_junctions == Some(WeldTolerance::Exact));
    }

    #[test]
    fn a_bare_option_is_exact() {
        let mut options = MendOptions::default();
        options.set("weld", "").expect("without a length");
        options.set("fill-holes", "").expect("without a number");
        let spec = options.spec();
        assert_eq!((spec.weld, spec.fill_holes), (Some(WeldTolerance::Exact), Some(HoleSelection::All)));
        assert!(options.set("fill-holes", "0").is_err() && options.set("weld", "-1").is_err());
    }
}
