//! Error messages that suggest what to write instead.
use chordal_script::{RunOptions, Script, ScriptError, run};

fn script(text: &str) -> Result<Script, ScriptError> {
    run(text, &RunOptions::default(), &Default::default())
}

#[test]
fn names_of_other_tools_lead_to_those_of_the_language() {
    for (text, expected) in [
        ("ball(1)", "Variable `ball` not found: use sphere(radius)"),
        ("cuboid(1, 2, 3)", "use box(x, y, z)"),
        ("linear_extrude(circle(1), 2)", "use extrude(shape, height)"),
        ("rotate_extrude(circle(1))", "use revolve(shape)"),
        ("x = 1\nhull_3d([[0, 0, 0]])", "line 2, column 1: Variable `hull_3d` not found: use hull(points"),
        ("rounded_extrude(circle(1), 2, 0.1)", "use extrude(shape, height, bevel, rounded)"),
        ("rounded(box(1, 1, 1), 0.1)", "extrude(shape, height, rounded=…)"),
        ("polyhedron([])", "mesh(name) for the triangles of a file"),
        ("offset2d(circle(1), 1)", "use offset(shape, by)"),
        // Capitals and underscores differ from tool to tool.
        ("Cube(1, 2, 3)", "Variable `Cube` not found: use box(x, y, z)"),
        ("Translate(sphere(1), 1, 0, 0)", "use move(shape, x, y, z)"),
        ("SPHERE(1)", "use sphere(radius)"),
        ("RoundedBox(1, 1, 1, 0.1)", "use rounded_box(x, y, z, radius)"),
        ("LinearExtrude(circle(1), 2)", "use extrude(shape, height)"),
        // If nothing better is known, a name with a similar spelling is suggested.
        ("spere(1)", "did you mean `sphere`?"),
        (
            "rotate(cylinder(1, 2), 90, axis='x')",
            "rotate() got 'axis' twice: call it as rotate(shape, axis, degrees)",
        ),
        ("cylinder(1)", "cylinder() needs 'height': call it as cylinder(radius, height)"),
        ("circle(1, 2)", "circle() takes 1 argument, but 2 were given: call it as circle(radius)"),
    ] {
        let error = script(text).unwrap_err();
        assert!(error.to_string().contains(expected), "{text}: {error}");
    }
}

#[test]
fn a_suggestion_is_a_word_that_is_close() {
    for (text, expected) in [
        // Every operator is a function of the program, and one letter away from any other.
        ("sphere(q)", "Variable `q` not found"),
        ("a = 1\nsphere(q)", "Variable `q` not found"),
        ("in_ = 1\nsphere(bin)", "Variable `bin` not found"),
        // The same letter in the other case is one.
        ("r = 1\nsphere(R)", "Variable `R` not found, did you mean `r`?"),
        ("ab = 1\nsphere(ac)", "Variable `ac` not found, did you mean `ab`?"),
        // A text of the script's own stays as it is.
        ("fail('x, did you mean `+`?')", "x, did you mean `+`?"),
    ] {
        let told = script(text).unwrap_err();
        assert!(told.message.ends_with(expected), "{text}: {told}");
    }
}

#[test]
fn a_missing_return_is_said_wherever_a_shape_is_needed() {
    let before = "def ball(r):\n    sphere(r)\n\ndef peg(r):\n    return cylinder(r, 1)\n\n";
    for line in [
        "union(peg(1), ball(2))",
        "union([ball(1)])",
        "move(ball(2), 1, 0, 0)",
        "peg(1) | ball(2)",
        "ball(1) - peg(2)",
    ] {
        let told = script(&format!("{before}{line}\n")).unwrap_err();
        for what in
            ["the result of a function without 'return'", "ball() returns nothing: end it with 'return'"]
        {
            assert!(told.message.contains(what) && told.place.is_some(), "{line}: {told}");
        }
        assert!(!told.message.contains("peg()"), "{told}");
    }
    let told = script(&format!("{before}{{\"a\": ball(1)}}\n")).unwrap_err();
    assert!(told.message.contains("the result of a function without 'return'"), "{told}");
}

#[test]
fn powers_are_written_out() {
    for (text, what) in
        [("sphere(2 ** 3)", "there is no '**': write x * x"), ("sphere(pow(2, 3))", "there is no pow()")]
    {
        let told = script(text).unwrap_err();
        assert!(told.message.contains(what) && told.place.is_some(), "{told}");
    }
    // What is advised is a power: 2 to the power of 3.
    let made = script("sphere(exp(3 * log(2)))");
    let depth = -made.unwrap().field.expr().at([0.0; 3]).unwrap();
    assert!((depth - 8.0).abs() < 1e-12, "{depth}");
}
