//! A spline through points: how smooth it is, and what moves with one of the points; beside it the single
//! polynomial through all of them.
use super::answer::ExhibitAnswer;
use super::plane::or_text;
use super::request::ExhibitRequest;
use chordal::check::curves::joins;
use chordal::explicit::parametric::Polynomial;
use chordal::explicit::spline::{Knots, catmull_rom, natural};
use chordal::explicit::{Curve, CurveEnds, CurveSegment};
use serde_json::{Value, json};

/// Steps of each piece. Chosen: it looks smooth.
const STEPS: usize = 20;
/// The most points.
const MOST: usize = 14;

/// Answers `{"points": [[x, y] × 2 to 14], "kind": "lines" | "catmull-rom" | "natural", "chosen": 2}`: the
/// spline and the polynomial through the points, with the share of the chosen point at each step.
pub(super) fn spline(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["points", "kind", "chosen"])?;
    let points = request.points::<2>("points", [2, MOST])?;
    let kind = request.word("kind", &["lines", "catmull-rom", "natural"])?;
    let chosen = request.number("chosen", [0.0, points.len() as f64 - 1.0])? as usize;
    // Both curves are linear in the points: through 1 at the chosen one and 0 at the others runs its share.
    let bumps: Vec<[f64; 1]> = (0..points.len()).map(|i| [f64::from(u8::from(i == chosen))]).collect();
    let nodes: Vec<f64> = (0..points.len()).map(|i| i as f64).collect();
    let (curve, bump) = (curve_of(&points, kind)?, curve_of(&bumps, kind)?);
    let polynomial = or_text(Polynomial::through(&nodes, &points))?;
    let swell = or_text(Polynomial::through(&nodes, &bumps))?;
    let pieces = points.len() - 1;
    let places: Vec<f64> = (0..=STEPS * pieces).map(|i| i as f64 / STEPS as f64).collect();
    let smooth: Vec<f64> = places.iter().map(|s| bump.at(*s)[0]).collect();
    let swung: Vec<f64> = places.iter().map(|s| swell.at(*s)[0]).collect();
    // A piece moves if anything inside it does; at its ends the points stay.
    let moves = |shares: &[f64]| {
        let inside = |piece: usize| &shares[piece * STEPS + 1..(piece + 1) * STEPS];
        (0..pieces).map(|piece| inside(piece).iter().any(|w| *w != 0.0)).collect::<Vec<_>>()
    };
    // Beyond the two neighbours of the chosen point.
    let beyond = |shares: &[f64]| {
        let far = places.iter().zip(shares).filter(|(s, _)| (**s - chosen as f64).abs() > 1.0);
        far.fold(0.0, |most, (_, w)| if w.abs() > most { w.abs() } else { most })
    };
    let class = joins(&curve).iter().map(|join| join.parametric).min().flatten();
    let moving = moves(&smooth);
    let mut answer = ExhibitAnswer::default();
    let mut samples = |at: &dyn Fn(f64) -> [f64; 2], shares: &[f64]| -> Value {
        let line: Vec<[f64; 2]> = places.iter().map(|s| at(*s)).collect();
        json!({ "line": answer.floats(line.as_flattened()), "shares": answer.floats(shares), "beyond": beyond(shares) })
    };
    let spline = samples(&|s| curve.at(s), &smooth);
    let single = samples(&|s| polynomial.at(s), &swung);
    answer.facts = json!({
        "spline": spline,
        "polynomial": single,
        "steps": STEPS,
        "pieces": pieces,
        "moving": moving.iter().filter(|moves| **moves).count(),
        "degree": pieces,
        "class": class,
    });
    Ok(answer)
}

fn curve_of<const D: usize>(points: &[[f64; D]], kind: &str) -> Result<Curve<D>, String> {
    match kind {
        "natural" => or_text(natural(points)),
        "catmull-rom" => or_text(catmull_rom(points, Knots::Uniform, CurveEnds::Open)),
        _ => {
            let lines = points.windows(2).map(|ends| CurveSegment::Line([ends[0], ends[1]]));
            or_text(Curve::new(lines.collect(), CurveEnds::Open))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(kind: &str) -> Value {
        let points: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i), f64::from(i * i % 5) - 2.0]).collect();
        let question = json!({ "exhibit": "spline", "points": points, "kind": kind, "chosen": 4 });
        spline(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn the_smoother_the_spline_the_farther_a_point_reaches() {
        let seen = ["lines", "catmull-rom", "natural"].map(facts_of);
        let of = |name: &str| seen.each_ref().map(|facts| facts[name].as_u64().unwrap());
        assert_eq!((of("class"), of("moving"), of("pieces")), ([0, 1, 2], [2, 4, 8], [8, 8, 8]));
        let beyond = |facts: &Value, curve: &str| facts[curve]["beyond"].as_f64().unwrap();
        assert_eq!(beyond(&seen[0], "spline"), 0.0);
        // A fourth of it is left after each piece of the natural spline; the polynomial grows.
        assert!(beyond(&seen[2], "spline") < 0.15 && beyond(&seen[2], "polynomial") > 1.0);
    }
}
