//! Moves triangles, and puts them together, with the histories of the inputs.
use super::composed::Composed;
use super::origin::InputOrigin;
use crate::report::{HistoryFacts, HistoryStart, InputFacts, StepBound, StepFacts, StepInput, StepOutput};
use crate::scene::placements::{IDENTITY, Matrix4, nodes_rounding};
use crate::{Input, MovedScene, Shape, Stretch, composed_bound, transform};
use chordal::budget::Bound;
use chordal::math::{add_up, greater};
use chordal_io::{Scene, WriteError};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

/// As [`transform()`], with the history: the certificate of a later result states its distance from the first shape of the
/// input, moved by the map. For that the certificate in the input is read and checked against its geometry.
///
/// # Errors
/// As for [`transform()`]; [`WriteError::Unsupported`] for other shapes than triangles.
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{FormatHint, convert, load, transform_input};
/// let hint = FormatHint { name: Some("triangle.obj"), ..FormatHint::default() };
/// let input = load(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", hint, &Default::default())?;
/// let mut map = [0.0; 16];
/// (map[0], map[5], map[10], map[13], map[15]) = (2.0, 2.0, 2.0, 5.0, 1.0);
/// let (twice, _) = transform_input(&input, &map)?;
/// let history = convert(twice, Format::Ply)?.certificate.history.unwrap();
/// assert_eq!(history.steps[0].inputs[0].sha256.as_deref(), input.sha256());
/// assert_eq!(history.steps[0].composed.as_ref().unwrap().places[0].map.unwrap()[7], 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn transform_input(input: &Input, matrix: &[f64; 16]) -> Result<(Input, Stretch), WriteError> {
    let composed = composed_of(input)?;
    let MovedScene { scene, stretch } = transform(scene_in(input)?, matrix)?;
    let error = stretch.interval(0.0, Some(composed.off())).1.unwrap_or(f64::INFINITY);
    let composed = Composed::placed(&[(vec![*matrix], &composed)], error);
    let moved = Input { n_bytes: input.n_bytes, ..Input::made(Shape::Scene(scene), input.format) };
    Ok((Input { composed: composed.map(Arc::new), ..moved }, stretch))
}

/// A scene of other triangles below its nodes, with their histories. `parts` are nodes, each with the input that it shows
/// together with everything below it.
///
/// # Errors
/// [`WriteError::Unsupported`] for other shapes than triangles.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::Format;
/// use chordal_verbs::{Frame, Input, Scene, Shape, compose_input};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let scene = Scene::from_mesh("triangle", mesh, Frame::default());
/// let part = Input::made(Shape::Scene(scene.clone()), Format::Ply);
/// let whole = compose_input(Input::made(Shape::Scene(scene), Format::Ply), &[(0, &part)])?;
/// assert!(whole.composed.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compose_input(input: Input, parts: &[(usize, &Input)]) -> Result<Input, WriteError> {
    let scene = scene_in(&input)?;
    let compositions = Compositions::new(parts.iter().map(|(_, part)| *part))?;
    let mut shown: Vec<Option<&Composed>> = vec![None; scene.nodes.len()];
    let mut errors = Vec::with_capacity(parts.len());
    for (node, part) in parts {
        let composed = compositions.of(part);
        shown.get_mut(*node).into_iter().for_each(|shown| *shown = composed);
        errors.push((*node, composed.map_or(0.0, Composed::off)));
    }
    let mut placed = Vec::with_capacity(parts.len());
    let mut open: Vec<(usize, Vec<Matrix4>)> =
        scene.roots.iter().rev().map(|root| (*root, Vec::new())).collect();
    while let Some((at, mut above)) = open.pop() {
        let node = &scene.nodes[at];
        if *node.matrix != IDENTITY {
            above.push(*node.matrix);
        }
        match shown[at] {
            Some(composed) => placed.push((above, composed)),
            None => open.extend(node.children.iter().rev().map(|child| (*child, above.clone()))),
        }
    }
    let composed = Composed::placed(&placed, composed_bound(scene, &errors));
    Ok(Input { composed: composed.map(Arc::new), ..input })
}

/// Triangles next to each other as they are, with their histories: `input` holds the triangles of all `parts`, in this
/// order.
///
/// # Errors
/// As for [`compose_input`].
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::Format;
/// use chordal_verbs::{Frame, Input, Scene, Shape, join_input};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let scene = Scene::from_mesh("triangle", mesh, Frame::default());
/// let part = Input::made(Shape::Scene(scene.clone()), Format::Ply);
/// assert!(join_input(part.clone(), &[&part])?.composed.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn join_input(input: Input, parts: &[&Input]) -> Result<Input, WriteError> {
    let compositions = Compositions::new(parts.iter().copied())?;
    let (mut placed, mut error) = (Vec::with_capacity(parts.len()), 0.0);
    for part in parts {
        let Some(composed) = compositions.of(part) else { continue };
        let rounding = nodes_rounding(scene_in(part)?);
        let part_error = composed.off();
        error = greater(
            // A sum with 0 is exact: rounded up, it would say that triangles moved that did not.
            if part_error == 0.0 || rounding == 0.0 {
                part_error + rounding
            } else {
                add_up(part_error, rounding)
            },
            error,
        );
        placed.push((Vec::new(), composed));
    }
    let composed = Composed::placed(&placed, error);
    Ok(Input { composed: composed.map(Arc::new), ..input })
}

/// The composition of triangles whose bound is in no certificate, for [`Input::composed`]: `bound` is against a shape of the
/// given kind. An example is a "volume" of which only some samples were read at a time.
///
/// # Errors
/// As for [`compose_input`].
///
/// ```
/// use chordal::Mesh;
/// use chordal::budget::{Bound, Reference};
/// use chordal_io::Format;
/// use chordal_verbs::{Frame, Input, Scene, Shape, convert, made_of};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut input = Input::made(Shape::Scene(Scene::from_mesh("triangle", mesh, Frame::default())), Format::Ply);
/// input.composed = Some(made_of(&input, "volume", &Bound::proved(0.0, 0.5, Reference::Trilinear))?.into());
/// let total = convert(input, Format::Ply)?.certificate.history.unwrap().total.unwrap();
/// assert_eq!((total.at_most, &total.reference[..]), (Some(0.5), "trilinear interpolant"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn made_of(input: &Input, kind: &str, bound: &Bound) -> Result<Composed, WriteError> {
    let facts = InputFacts::from_input(input).of_step();
    let source =
        StepInput { kind: kind.to_owned(), format: facts.format.clone(), sha256: None, files: Vec::new() };
    let step = StepFacts {
        verb: "mesh".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        inputs: vec![source],
        composed: None,
        offset: None,
        output: StepOutput {
            kind: facts.kind.clone(),
            format: facts.format.clone(),
            geometry: facts.sha256.clone(),
        },
        bound: Some(StepBound::new(bound)),
    };
    let begins = HistoryStart::new("no-certificate", "the triangles were never a file of their own");
    let origin = HistoryFacts::new(begins, vec![step]);
    Composed::of_one(facts, origin, scene_in(input)?)
}

/// The origin of an input, as far as its certificate proves it or it is known otherwise: the start of the history of a
/// result, with the distance of the input from the first shape.
///
/// ```
/// use chordal_verbs::{FormatHint, history_of, load};
/// let plain = load(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", FormatHint::default(), &Default::default())?;
/// assert_eq!(history_of(&plain).begins.code, "no-certificate");
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
#[must_use]
pub fn history_of(input: &Input) -> HistoryFacts {
    let InputOrigin { steps, begins, composed, .. } = InputOrigin::from_input(input);
    let mut history = HistoryFacts::new(begins, steps);
    if let Some(composed) = composed {
        history.total = composed.facts().bound().as_ref().map(StepBound::new);
    }
    history
}

/// The compositions of inputs; an input that occurs several times is read once.
struct Compositions(BTreeMap<*const Input, Composed>);

impl Compositions {
    fn new<'a>(parts: impl Iterator<Item = &'a Input>) -> Result<Self, WriteError> {
        let mut compositions = BTreeMap::new();
        for part in parts {
            if let Entry::Vacant(free) = compositions.entry(std::ptr::from_ref(part)) {
                free.insert(composed_of(part)?);
            }
        }
        Ok(Self(compositions))
    }

    fn of(&self, part: &Input) -> Option<&Composed> {
        self.0.get(&std::ptr::from_ref(part))
    }
}

/// The inputs that an input was put together from: the input itself if it was not.
fn composed_of(input: &Input) -> Result<Composed, WriteError> {
    if let Some(composed) = &input.composed {
        return Ok(Composed::clone(composed));
    }
    let InputOrigin { steps, begins, .. } = InputOrigin::from_input(input);
    let facts = InputFacts::from_input(input).of_step();
    Composed::of_one(facts, HistoryFacts::new(begins, steps), scene_in(input)?)
}

fn scene_in(input: &Input) -> Result<&Scene, WriteError> {
    let Shape::Scene(scene) = &input.shape else {
        return Err(WriteError::Unsupported(format!("{} are not triangles", input.shape.kind())));
    };
    Ok(scene)
}
