//! `sphere_trace`: the steps of a ray that advances by the value of a field, which is free of surface.
use super::super::{LeafError, Tape};
use super::beam::Beam;
use super::point_queries::along;
use crate::math::length;

/// A step of a sphere trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereStep {
    /// Where it starts, in multiples of the beam's direction.
    pub t: f64,
    /// The point there.
    pub point: [f64; 3],
    /// The value there: the radius of a ball without surface, if the value is at most the distance.
    pub value: f64,
}

/// How a sphere trace ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SphereTraceEnd {
    /// The last value is not above the beam's radius there.
    Arrived,
    /// The last point is beyond the end of the beam.
    Passed,
    /// The step limit was reached, or a value is NaN.
    Stopped,
}

/// The steps of a beam, the first at its start.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereTrace {
    /// The evaluated points, in order.
    pub steps: Vec<SphereStep>,
    /// How it ended.
    pub end: SphereTraceEnd,
}

/// Sphere tracing, step by step: from each point the beam advances by the value there. It is the plain
/// method, for illustration; [`FieldTracer`](super::FieldTracer) answers many beams, faster and with
/// brackets.
///
/// No surface is skipped if the value is at most the distance to it. A beam arrives when the value is at most
/// its radius, and at most `most` values are evaluated. Cost: one value per step. Beams that graze a surface
/// take many steps: near it all steps are short.
///
/// # Errors
/// When a leaf fails.
///
/// ```
/// use chordal::implicit::query::{Beam, SphereTraceEnd, sphere_trace};
/// use chordal::implicit::shapes::sphere;
/// let ball = sphere(1.0).unwrap().tape();
/// let beam = |height| Beam { origin: [-4.0, height, 0.0], direction: [1.0, 0.0, 0.0], from: 0.0, to: 9.0, cone: [0.001, 0.0] };
/// let straight = sphere_trace(&ball, &beam(0.0), 99)?;
/// assert_eq!((straight.end, straight.steps.len()), (SphereTraceEnd::Arrived, 2)); // one leap, and the answer there
/// let grazing = sphere_trace(&ball, &beam(1.0005), 99)?;
/// assert!(grazing.steps.len() > 8);
/// # Ok::<(), chordal::implicit::leaves::LeafError>(())
/// ```
///
/// Source: J. C. Hart, *Sphere tracing*, 1996.
pub fn sphere_trace(tape: &Tape, beam: &Beam, most: usize) -> Result<SphereTrace, LeafError> {
    let unit = length(beam.direction);
    let mut trace = SphereTrace { steps: Vec::new(), end: SphereTraceEnd::Stopped };
    let mut t = beam.from;
    while trace.steps.len() < most {
        let point = along(beam.origin, beam.direction, t);
        let mut value = [0.0];
        tape.at(&[point], &mut value)?;
        let [value] = value;
        trace.steps.push(SphereStep { t, point, value });
        if t > beam.to {
            trace.end = SphereTraceEnd::Passed;
            break;
        }
        if value <= beam.cone[0] + beam.cone[1] * t * unit {
            trace.end = SphereTraceEnd::Arrived;
            break;
        }
        let next = t + value / unit;
        // The step is lost in rounding, or the value is NaN.
        if !(next.is_finite() && next > t) {
            break;
        }
        t = next;
    }
    Ok(trace)
}

#[cfg(test)]
mod tests {
    use super::super::{FieldOctree, FieldTracer};
    use super::*;
    use crate::budget::Job;
    use crate::implicit::shapes::{rectangle, sphere};

    fn beam(origin: [f64; 3], direction: [f64; 3]) -> Beam {
        Beam { origin, direction, from: 0.0, to: 20.0, cone: [1e-9, 0.0] } // chosen: close
    }

    #[test]
    fn it_stays_outside_and_arrives_where_the_bracketing_tracer_does() {
        let ball = sphere(1.5).unwrap();
        let cells = FieldOctree::build(&ball, &Job::default()).unwrap();
        for height in [0.0, 0.7, 1.4, 1.48] {
            let beam = beam([-5.0, height, 0.2], [0.5, 0.0, 0.0]);
            let trace = sphere_trace(&ball.tape(), &beam, 1000).unwrap();
            let hit = FieldTracer::new(&cells).intersect(&[beam]).unwrap()[0].hit.unwrap();
            let last = trace.steps.last().unwrap();
            assert_eq!(trace.end, SphereTraceEnd::Arrived);
            assert!((last.t - hit.t).abs() < 1e-6, "{} {}", last.t, hit.t); // measured: grazing, 1e-9 is 1e-7 away
            assert!(trace.steps.iter().all(|step| step.value > -1e-12)); // derived: rounding
            assert!(trace.steps.windows(2).all(|w| (w[1].t - w[0].t - 2.0 * w[0].value).abs() < 1e-12)); // derived: rounding
        }
    }

    #[test]
    fn it_passes_by_and_it_stops_at_the_limit() {
        let wall = rectangle([2.0, 6.0]).unwrap().tape();
        let past = sphere_trace(&wall, &beam([-5.0, 3.5, 0.0], [1.0, 0.0, 0.0]), 1000).unwrap();
        assert_eq!(past.end, SphereTraceEnd::Passed);
        let short = sphere_trace(&wall, &beam([-5.0, 3.5, 0.0], [1.0, 0.0, 0.0]), 4).unwrap();
        assert_eq!((short.end, short.steps.len()), (SphereTraceEnd::Stopped, 4));
        assert_eq!(short.steps[..], past.steps[..4]);
    }
}
