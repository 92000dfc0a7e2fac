//! `FindingFacts`: a defect, its meaning, and its repairs.
use super::surface::SurfaceFacts;
use super::validity::ValidityFacts;
use super::{message_option, message_text, message_texts};
use chordal::budget::advice::{Cure, Message, Setting};
use chordal::check::Defect;
use chordal::check::findings::Severity;
use serde::Serialize;
use std::collections::BTreeMap;

/// A sentence by its code and the values in it, for readers of another language.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SentenceFacts {
    /// Stable, for programs; the meaning of a defect has the name of its count.
    pub code: &'static str,
    /// The values, by their names.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub values: BTreeMap<&'static str, String>,
}

impl SentenceFacts {
    fn plain(code: &'static str) -> Self {
        Self { code, values: BTreeMap::new() }
    }
}

/// One kind of defect that was found, in words, with its repairs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FindingFacts {
    /// The name of its count.
    pub of: &'static str,
    /// How often it occurs.
    pub count: u64,
    /// "fault" if the surface is invalid, "remark" if its triangles could be better.
    pub weight: &'static str,
    /// Its name in words, singular or plural.
    pub words: &'static str,
    /// Its meaning, as half a sentence.
    #[serde(serialize_with = "message_text")]
    pub means: Message,
    /// The sentences of the meaning.
    pub sentences: Vec<SentenceFacts>,
    /// The repairs, in this order; empty if there is none.
    #[serde(skip)]
    pub cures: Vec<Cure>,
    /// The repairs as settings of `mend`, for readers of a report.
    #[serde(rename = "cures", serialize_with = "message_texts")]
    pub options: Vec<Message>,
    /// The advice if nothing repairs it.
    #[serde(serialize_with = "message_option")]
    pub advice: Option<Message>,
    /// The code of the advice; that on a defect in general has the name of its count.
    pub advice_code: Option<&'static str>,
}

impl FindingFacts {
    /// All defects that were found, the most severe first. Empty if there are no triangles, since a set of points needs
    /// none.
    #[must_use]
    pub fn list(valid: &ValidityFacts) -> Vec<Self> {
        if !valid.has_triangles() {
            return Vec::new();
        }
        let finding_of = |defect: &Defect| {
            let count = valid.count(*defect).filter(|count| *count > 0)?;
            // If all of them are collapsed, that finding is more precise.
            let covered = *defect == Defect::ZeroAreaFaces && count == valid.counts.collapsed_faces;
            (!covered).then(|| Self::new(*defect, count, valid))
        };
        let mut findings: Vec<Self> = Defect::ALL.iter().filter_map(finding_of).collect();
        let tried = valid.anatomy.as_ref().and_then(|anatomy| anatomy.prescribed.as_ref());
        add_consequences(&mut findings, tried.map_or(&[], Vec::as_slice));
        for finding in &mut findings {
            let option = |cure: &Cure| Message::default().setting(Setting::Cure(*cure));
            finding.options = finding.cures.iter().map(option).collect();
        }
        findings
    }

    /// Whether any defect was found for which a repair exists.
    pub(super) fn has_repairable(valid: &ValidityFacts, anatomy: &SurfaceFacts) -> bool {
        let is_met = |defect: &&Defect| match defect {
            Defect::InsideOut => anatomy.inside_out > 0,
            _ => valid.count(**defect).is_some_and(|count| count > 0),
        };
        Defect::ALL.iter().filter(is_met).any(|defect| !defect.cures().is_empty())
    }

    fn new(defect: Defect, count: u64, valid: &ValidityFacts) -> Self {
        let cures = cures(defect, valid);
        let seams = valid.anatomy.as_ref().and_then(|anatomy| anatomy.open_seams.as_ref());
        let [one, several] = defect.words();
        let open = seams.filter(|_| defect == Defect::BoundaryEdges);
        let fills = open.is_none() && cures.contains(&Cure::FillHoles);
        let besides = match open {
            Some(seams) => Some(SentenceFacts {
                code: "nearly-joined",
                values: BTreeMap::from([
                    ("vertices", seams.vertices.to_string()),
                    ("within", seams.tolerance()),
                ]),
            }),
            None => fills.then(|| SentenceFacts::plain("filling-may-cross")),
        };
        let (advice_code, advice) = advice(defect, valid, &cures).unzip();
        Self {
            of: defect.name(),
            count,
            weight: if defect.severity() == Severity::Fault { "fault" } else { "remark" },
            words: if count == 1 { one } else { several },
            // The meaning mentions the side effect of a repair.
            means: match open {
                Some(seams) => seams.meaning(),
                None if fills => may_cross(),
                None => defect.meaning().into(),
            },
            sentences: std::iter::once(SentenceFacts::plain(defect.name())).chain(besides).collect(),
            advice,
            advice_code,
            cures,
            options: Vec::new(),
        }
    }
}

/// The meaning of a boundary that can be filled.
fn may_cross() -> Message {
    Message::from("the surface ends there, so that it has no inside; ")
        .words("the filling may cross the surface, which `inspect ")
        .setting(Setting::SelfIntersections)
        .words("` shows afterwards")
}

/// The repairs of a defect that help.
fn cures(defect: Defect, valid: &ValidityFacts) -> Vec<Cure> {
    let (counts, other) = (&valid.counts, &valid.other.counts);
    let tried = valid.anatomy.as_ref().and_then(|anatomy| anatomy.prescribed.as_ref());
    // Equal points may keep sheets apart that would branch, touch or disagree: then welding would undo a split.
    let sound = other.non_manifold_edges <= counts.non_manifold_edges
        && other.non_manifold_vertices <= counts.non_manifold_vertices
        && other.duplicate_faces <= counts.duplicate_faces
        && other.inconsistent_edges <= counts.inconsistent_edges;
    let helps = |cure: Cure| match (defect, cure) {
        (Defect::BoundaryEdges, Cure::Weld) => {
            sound && counts.duplicate_vertices > 0 && other.boundary_edges < counts.boundary_edges
        }
        (Defect::DuplicateVertices, Cure::Weld) => sound,
        (Defect::BoundaryEdges, Cure::ResolveTJunctions) => {
            counts.t_junctions > 0 || counts.duplicate_vertices > 0 && other.t_junctions > 0
        }
        (Defect::NonManifoldEdges, Cure::DropDuplicates) => counts.duplicate_faces > 0,
        (Defect::InconsistentEdges, Cure::Orient) => counts.orientable,
        _ => true,
    };
    let was_tried = |cure: &Cure| tried.is_none_or(|tried| tried.contains(cure));
    defect.cures().iter().copied().filter(|cure| helps(*cure) && was_tried(cure)).collect()
}

/// Adds repairs for defects that other repairs expose: a filled hole has an outside for orientation, a dropped face leaves
/// vertices.
fn add_consequences(findings: &mut [FindingFacts], tried: &[Cure]) {
    for cure in tried {
        if findings.iter().any(|finding| finding.cures.contains(cure)) {
            continue;
        }
        let fills = |finding: &FindingFacts| finding.cures.contains(&Cure::FillHoles);
        let filled = findings.iter().position(|finding| *cure == Cure::Orient && fills(finding));
        let cause = filled.or_else(|| findings.iter().position(|finding| !finding.cures.is_empty()));
        if let Some(finding) = cause.or((!findings.is_empty()).then_some(0)) {
            findings[finding].cures.push(*cure);
            findings[finding].cures.sort_unstable();
        }
    }
}

/// The advice for a defect that nothing repairs, after its code.
fn advice(defect: Defect, valid: &ValidityFacts, cures: &[Cure]) -> Option<(&'static str, Message)> {
    let ties = valid.topology == "positions";
    match defect {
        _ if !cures.is_empty() => None,
        Defect::NonManifoldEdges | Defect::NonManifoldVertices if ties => {
            let split = Message::from("`chordal mend ").setting(Setting::Cure(Cure::SplitNonManifold));
            let message = split.words("` into OBJ or PLY: this format ties equal positions together again");
            Some(("split-and-keep-apart", message))
        }
        Defect::BoundaryEdges if valid.counts.orientable => {
            let message = "an open sheet, or sheets that branch: leave it, or give it thickness in the program that made it";
            Some(("open-sheet", message.into()))
        }
        _ => Some((defect.name(), defect.advice().into())),
    }
}

/// The repairs of all findings, in the order in which to apply them.
#[must_use]
pub fn cures_of_all(findings: &[FindingFacts]) -> Vec<Cure> {
    let wanted = |cure: &Cure| findings.iter().any(|finding| finding.cures.contains(cure));
    Cure::ALL.into_iter().filter(wanted).collect()
}

impl ValidityFacts {
    /// If repairs are needed, stores the repairs that helped when they were tried.
    pub(crate) fn prescribe(&mut self, recommend: impl FnOnce() -> Option<Vec<Cure>>) {
        if self.anatomy.as_ref().is_some_and(|anatomy| FindingFacts::has_repairable(self, anatomy)) {
            let prescribed = recommend();
            self.anatomy.iter_mut().for_each(|anatomy| anatomy.prescribed.clone_from(&prescribed));
        }
    }
}
