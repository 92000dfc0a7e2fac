//! Sphere tracing: each step of a ray is as long as the value of the field allows.
use super::answer::ExhibitAnswer;
use super::plane::{Latest, Region, below, latest, loops, or_text, outline, raised, regions};
use super::request::ExhibitRequest;
use chordal::convert::shader::field_to_shader;
use chordal::explicit::Polyline;
use chordal::implicit::Field;
use chordal::implicit::evaluation::Tape;
use chordal::implicit::query::{Beam, SphereTrace, SphereTraceEnd, sphere_trace};
use chordal::implicit::shapes::{capsule, circle, cuboid, cylinder, rounded_rectangle, segment, sphere};
use chordal::math::Box3;
use serde_json::json;
use std::sync::Mutex;

/// The eye.
const EYE: [f64; 2] = [0.9, 4.2];
/// A ray that is closer to the surface has arrived.
const CLOSE: f64 = 0.01; // chosen: less than a pixel of the figure
/// A ray of this length has left the figure.
const AWAY: f64 = 14.0;
const MOST: usize = 250; // chosen: more than any ray here takes
/// The range of directions whose steps are counted, in degrees.
const FAN: [i32; 2] = [-42, 42];
const PER_DEGREE: i32 = 2;

/// Answers `{"aim": [x, y], "parts": [[x, y], …]}`: the steps of the ray from the eye through a point, and the number of steps in
/// each direction of a fan.
pub(super) fn tracing(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["aim", "parts"])?;
    let aim = request.point::<2>("aim")?;
    let toward = [aim[0] - EYE[0], aim[1] - EYE[1]];
    let far = (toward[0] * toward[0] + toward[1] * toward[1]).sqrt();
    if far < CLOSE {
        return Err(format!("the ray needs a point other than the eye, {EYE:?}"));
    }
    let parts = request.points::<2>("parts", [3, 3])?;
    let shape = shapes(&parts)?;
    let trace = traced(&shape.tape(), toward.map(|x| x / far))?;
    static MADE: Latest<Vec<[f64; 2]>, Scenery> = Mutex::new(None);
    let scenery = latest(&MADE, parts, || scenery(&shape))?;
    let mut answer = ExhibitAnswer::default();
    let levels = regions(&mut answer, &scenery.levels);
    answer.facts = json!({
        "levels": levels,
        "outline": loops(&mut answer, &scenery.outline),
        "eye": EYE,
        "close": CLOSE,
        "steps": trace.steps.iter().map(|step| json!({
            "at": [step.point[0], step.point[1]], "t": step.t, "value": step.value,
        })).collect::<Vec<_>>(),
        "end": match trace.end {
            SphereTraceEnd::Arrived => "arrived",
            SphereTraceEnd::Passed => "passed",
            SphereTraceEnd::Stopped => "stopped",
        },
        "fan": scenery.fan,
        "shader": scenery.shader,
    });
    Ok(answer)
}

/// The parts of the answer that do not depend on the ray.
struct Scenery {
    levels: Vec<Region>,
    outline: Vec<Polyline<2>>,
    /// Directions in degrees, with their numbers of steps.
    fan: Vec<(f64, usize)>,
    /// Shapes in space for the graphics processor.
    shader: String,
}

fn scenery(shape: &Field) -> Result<Scenery, String> {
    let tape = shape.tape();
    let mut fan = Vec::new();
    for turn in FAN[0] * PER_DEGREE..=FAN[1] * PER_DEGREE {
        let deg = f64::from(turn) / f64::from(PER_DEGREE);
        let (sin, cos) = chordal::math::elementary::sin_cos(deg.to_radians());
        fan.push((deg, traced(&tape, [cos, sin])?.steps.len()));
    }
    let levels = below(shape.expr(), &[2.0, 1.5, 1.0, 0.5], 0.125)?;
    let shader = or_text(field_to_shader(&solids()?, "shapes"))?.source;
    let outline = outline(shape, 0.002)?; // chosen: below a pixel of the figure
    Ok(Scenery { levels, outline, fan, shader })
}

fn traced(tape: &Tape, [x, y]: [f64; 2]) -> Result<SphereTrace, String> {
    let beam = Beam { origin: raised(EYE), direction: [x, y, 0.0], from: 0.0, to: AWAY, cone: [CLOSE, 0.0] };
    or_text(sphere_trace(tape, &beam, MOST))
}

/// A ball, a wall and a bar, by their middles.
fn shapes(parts: &[[f64; 2]]) -> Result<Field, String> {
    let at = |k: usize| [parts[k][0], parts[k][1], 0.0];
    let ball = or_text(or_text(circle(1.25))?.moved(at(0)))?;
    let wall = or_text(or_text(rounded_rectangle([1.5, 3.4], 0.25))?.moved(at(1)))?;
    let bar = or_text(or_text(segment([-1.9, -0.45], [1.9, 0.45], 0.45))?.moved(at(2)))?;
    Ok(ball.union(&wall).union(&bar))
}

/// A wall with a hole, a ball and a bar in space, in a box around every eye, so that all rays are traced.
fn solids() -> Result<Field, String> {
    let hole = or_text(or_text(cylinder(0.75, 2.0))?.rotated_deg([1.0, 0.0, 0.0], 90.0))?;
    let wall = or_text(or_text(cuboid([3.0, 0.7, 2.6]))?.difference(&hole).moved([0.0, 1.2, 0.0]))?;
    let ball = or_text(or_text(sphere(0.8))?.moved([-0.9, -0.7, -0.5]))?;
    let bar = or_text(capsule([-0.1, -1.5, -1.0], [1.5, 0.0, -0.2], 0.3))?;
    let everything = Box3 { min: [-40.0; 3], max: [40.0; 3] };
    Ok(wall.union(&ball).union(&bar).with_bounds(everything))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(aim: [f64; 2]) -> serde_json::Value {
        let parts = [[6.1, 6.0], [10.3, 4.0], [5.5, 2.05]];
        let question = json!({ "exhibit": "tracing", "aim": aim, "parts": parts }).to_string();
        tracing(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn a_ray_that_grazes_takes_many_more_steps_than_one_that_hits() {
        let [hit, grazing] = [[6.1, 6.0], [7.4, 2.97]].map(at);
        let steps = |facts: &serde_json::Value| facts["steps"].as_array().unwrap().len();
        assert_eq!(hit["end"], "arrived");
        assert!(steps(&hit) < 10 && steps(&grazing) > 2 * steps(&hit), "{} {}", steps(&hit), steps(&grazing));
        let last = hit["steps"].as_array().unwrap().last().unwrap()["value"].as_f64().unwrap();
        assert!(last.abs() <= CLOSE, "{last}");
        assert_eq!(at([0.9, 0.2])["end"], "passed");
    }
}
