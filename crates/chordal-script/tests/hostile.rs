//! Scripts that want too much: each ends with one error, soon, and without taking the machine's memory.
use chordal::Job;
use chordal_script::{Limits, RunOptions, ScriptError, run};
use chordal_testkit::Random;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Counts what this thread holds and held at most.
struct Counting;

thread_local! {
    static HELD: Cell<(isize, isize)> = const { Cell::new((0, 0)) };
}

fn count(change: isize) {
    // A thread that is ending has no counter any more.
    let _ = HELD.try_with(|cell| {
        let (held, most) = cell.get();
        cell.set((held + change, most.max(held + change)));
    });
}

// SAFETY: every call is passed on to the system's allocator unchanged; counting touches no memory of its
// blocks.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn measured(text: &str) -> (Result<(), ScriptError>, isize) {
    let before = HELD.with(|cell| {
        let (held, _) = cell.get();
        cell.set((held, held));
        held
    });
    let result = run(text, &RunOptions::default(), &Job::default()).map(|_| ());
    let (_, most) = HELD.with(Cell::get);
    (result, most - before)
}

/// The most that a script may hold: twice its heap, since lists grow by doubling, and what its shapes take.
const MOST: isize = 1 << 30;

#[test]
fn bombs_end_with_an_error() {
    let doubling =
        |start: &str, step: &str| format!("a = {start}\nfor i in range(60):\n    {step}\nsphere(1)");
    let shared = || {
        format!(
            "a = [0]\nfor i in range({}):\n    a = [a, a]\nsphere(1)",
            std::env::var("BOMB").map_or(60, |n| n.parse().unwrap())
        )
    };
    let texts = [
        ("recursion", "def f(n):\n    return f(n + 1)\nf(0)".to_owned()),
        ("mutual recursion", "def f(n):\n    return g(n)\ndef g(n):\n    return f(n)\nf(0)".to_owned()),
        (
            "exponential calls",
            "def f(n):\n    return f(n - 1) + f(n - 1) if n else 1\nsphere(f(40))".to_owned(),
        ),
        ("a long loop", "for i in range(1000000000):\n    pass\nsphere(1)".to_owned()),
        (
            "nested loops",
            "for i in range(100000):\n    for j in range(100000):\n        pass\nsphere(1)".to_owned(),
        ),
        (
            "nested comprehensions",
            "[1 for a in range(9999) for b in range(9999) for c in range(9999)]".to_owned(),
        ),
        ("comprehensions that keep", "[range(100000) for a in range(100000)]".to_owned()),
        ("a huge list", "a = [0] * 2000000000".to_owned()),
        ("a huge tuple", "a = 2000000000 * (1, 2)".to_owned()),
        ("a huge text", "a = 'abc' * 2000000000".to_owned()),
        ("doubled lists", doubling("[0]", "a = a + a")),
        ("doubled lists in place", doubling("[0]", "a += a")),
        ("doubled texts", doubling("'a'", "a = a + a")),
        ("doubled texts in place", doubling("'a'", "a += a")),
        (
            "doubled in a lambda",
            "[0 for f in [lambda a: [a + a for i in range(9999)]] for b in f([0] * 1000000)]".to_owned(),
        ),
        ("squared numbers", doubling("3", "a = a * a")),
        ("shifted numbers", "1 << 1000000000".to_owned()),
        ("added numbers", "a = 3\nfor i in range(1000000):\n    a += a\nsphere(1)".to_owned()),
        ("added sums", "a = 3\nfor i in range(1000000):\n    a = sum([a, a])\nsphere(1)".to_owned()),
        ("negated numbers", format!("a = {}\n[-a for i in range(1000000)]", "9".repeat(200_000))),
        ("appended lists", "a = []\nfor i in range(100000000):\n    a.append(a)".to_owned()),
        ("unions of itself", doubling("sphere(1)", "a = a | move(a, i, 0)")),
        ("unions of itself in place", doubling("sphere(1)", "a |= move(a, i, 0)")),
        ("twists of twists", "a = box(1, 1, 1)\nfor i in range(1000000):\n    a = twist(a, 1)\na".to_owned()),
        ("copies of copies", doubling("sphere(1)", "a = repeat(a, x=0.01, nx=9)")),
        ("doubled formulas", doubling("x", "a = a * a")),
        ("doubled formulas in place", format!("{}\nfield(a)", doubling("x", "a += a"))),
        ("many shapes", "union([move(sphere(1), i, 0) for i in range(1000000)])".to_owned()),
        ("many corners", "polygon([[i, i * i] for i in range(1000000)])".to_owned()),
        ("many arguments", "a = [0] * 1000000\n[len(*a) for i in range(1000000)]".to_owned()),
        ("shown bombs", format!("{}()", shared().replace("sphere(1)", "a"))),
        ("compared bombs", shared().replace("sphere(1)", "b = [a, a]\na == b")),
        ("searched bombs", shared().replace("sphere(1)", "b = [a, a]\na in b")),
        ("used bombs", shared().replace("sphere(1)", "box(a, a, a)")),
        ("indexing bombs", shared().replace("sphere(1)", "a[a]")),
        ("negative bombs", shared().replace("sphere(1)", "-a")),
        ("unpacked bombs", shared().replace("sphere(1)", "b, c, d = a")),
        ("bombs as messages", shared().replace("sphere(1)", "fail(a)")),
        ("bombs as counts", shared().replace("sphere(1)", "range(a)")),
        ("bombs as conditions", shared().replace("sphere(1)", "sphere(a if a else a)")),
        ("sorted bombs", shared().replace("sphere(1)", "max(a)")),
        ("a list within itself", "a = []\na.append(a)\nunion(a)".to_owned()),
        ("a long text", format!("# {}\nsphere(1)", "a".repeat(1 << 18))),
        ("brackets", "(".repeat(100_000)),
        ("lists", format!("{}{}", "[".repeat(100_000), "]".repeat(100_000))),
        ("minus", format!("{}1", "-".repeat(100_000))),
        ("not", format!("{}1", "not ".repeat(50_000))),
        ("a sum", format!("sphere({}1)", "1+".repeat(100_000))),
        ("calls", format!("a{}", "()".repeat(100_000))),
        ("attributes", format!("a{}", ".append".repeat(30_000))),
        ("lambdas", format!("{}1", "lambda:".repeat(30_000))),
        ("conditions", format!("{}1", "1 if 1 else ".repeat(20_000))),
        ("branches", format!("if 0:\n pass\n{}", "elif 0:\n pass\n".repeat(15_000))),
        ("blocks", (0..700).map(|k| format!("{}if 1:\n", " ".repeat(k))).collect()),
        ("assignments", format!("{}1", "a = ".repeat(50_000))),
        ("comparisons", format!("{}1", "1 < ".repeat(50_000))),
        ("not a number", "sphere(1e999 - 1e999)".to_owned()),
        ("infinite sizes", "box(1e999, 1, 1)".to_owned()),
        ("huge counts", "prism(4000000000, 1, 1)".to_owned()),
    ];
    for (name, text) in texts {
        let (result, held) = measured(&text);
        let error = result.expect_err(name);
        println!("{name}: {:.1} MB: {} {error}", held as f64 / 1e6, error.code);
        assert!(!error.message.is_empty() && error.message.len() < 1000, "{name}");
        assert!(held < MOST, "{name}: {held} bytes");
    }
}

/// What the limits allow has to fit into the stack of a thread, which has 2 MiB.
#[test]
fn what_is_just_within_the_limits_runs() {
    let most = 190;
    for text in [
        format!("{}sphere(1){}", "(".repeat(most), ")".repeat(most)),
        format!("sphere({}1)", "-".repeat(most / 2 * 2)),
        format!("sphere({}1)", "not ".repeat(most))
            .replace("sphere(not", "sphere(1) if (not")
            .replace("1)", "1) else sphere(1)"),
        format!("sphere({}1)", "1+".repeat(most)),
        format!("sphere({}1)", "1 if 1 else ".repeat(most / 2 - 2)),
        format!("a = [sphere(1)]\n{}a[0]{}", "[".repeat(most / 2), "][0]".repeat(most / 2)),
        format!("({}sphere(1)){}", "lambda:(".repeat(60), ")()".repeat(60).replace("()", ")()"))
            .replace(")))()", "))()"),
        format!("def f(n):\n    return f(n - 1) if n > 0 else sphere(1)\nf({})", 20),
        format!("if 0:\n    0\n{}else:\n    0\nsphere(1)", "elif 0:\n    0\n".repeat(most)),
    ] {
        let end = run(&text, &RunOptions::default(), &Job::default());
        if let Err(error) = end {
            assert!(["script-error", "script-syntax"].contains(&error.code), "{text}: {error}");
            println!("{error}");
        }
    }
    let wide = format!("union({})", vec!["sphere(1)"; 10_000].join(", "));
    assert!(run(&wide, &RunOptions::default(), &Job::default()).is_ok());
    let long = format!("a = sphere(1)\n{}a", "a = a | sphere(1)\n".repeat(9_000));
    assert!(run(&long, &RunOptions::default(), &Job::default()).is_ok());
}

#[test]
fn each_limit_is_kept() {
    let refused = |text: &str, limits: Limits| {
        let error = run(text, &RunOptions { limits, ..RunOptions::default() }, &Job::default()).unwrap_err();
        assert_eq!(error.code, "script-limit", "{text}: {error}");
        error.message
    };
    let usual = Limits::default();
    refused("sphere(1) # and more", Limits { bytes: 10, ..usual });
    refused("sphere(((((1)))))", Limits { nesting: 5, ..usual });
    refused("for i in range(5000):\n    pass", Limits { ticks: 1000, ..usual });
    refused("range(1000)", Limits { work: 100, ..usual });
    refused("a = []\nfor i in range(10000):\n    a.append([i])", Limits { heap: 100_000, ..usual });
    refused("def f(n):\n    return f(n - 1) if n else sphere(1)\nf(30)", Limits { calls: 20, ..usual });
    refused("sphere(1) | sphere(1)", Limits { terms: 10, ..usual });
}

#[test]
fn a_cancelled_job_ends_a_script() {
    let job = Job::default();
    job.cancel();
    let error = run("sphere(1)", &RunOptions::default(), &job).unwrap_err();
    assert_eq!(error.code, "cancelled");
}

/// Texts in which the operator of an assignment stands in a comment too, before the operator itself: what follows
/// the comment must not become statements that no meter sees.
#[test]
fn no_comment_hides_what_is_run() {
    let hidden =
        "a = [0]\n([\"\"\"\n)\nx = [0]\nx *= 2000000000\n(\n\"\"\"][0] # +=\n) += 1 # \"\"\" )\nsphere(1)\n";
    let spread = "a = [[0, 5]]\n(a\n[0][1]) += 2\nsphere(a[0][1])\n";
    assert!(run(hidden, &RunOptions::default(), &Job::default()).is_err());
    let made = run(spread, &RunOptions::default(), &Job::default()).unwrap();
    assert_eq!(made.field.bounds().max, [7.0; 3]);
}

/// A carriage return alone is part of a string for the parser, and its end for others.
#[test]
fn a_carriage_return_alone_is_refused_and_before_a_line_feed_it_is_none() {
    for text in
        ["a = [1]\na[\"\r(\"] += 1\nx = \"\r)\"\n", &format!("x = \"\r'''\"\n{}1", "-".repeat(200_000))]
    {
        let error = run(text, &RunOptions::default(), &Job::default()).unwrap_err();
        assert_eq!(error.code, "script-syntax");
    }
    let made =
        run("a = 1\r\na += \\\r\n 2\r\nsphere(a)\r\n", &RunOptions::default(), &Job::default()).unwrap();
    assert_eq!(made.field.bounds().max, [3.0; 3]);
}

/// An assignment to an element that is found by calls and indices.
#[test]
fn targets_with_calls_and_indices_are_metered_too() {
    let text =
        "def first():\n    return 0\na = [[1, 2], 3]\nb = [0]\na[b[0]][first()] += 4\nsphere(a[0][0])\n";
    let made = run(text, &RunOptions::default(), &Job::default()).unwrap();
    assert_eq!(made.field.bounds().max, [5.0; 3]);
}

/// Many warnings: their places are found in one pass over the text.
#[test]
fn each_of_many_cuts_has_its_place() {
    let text = format!("s = sphere(1)\n[{}]\ns\n", "s|s-s,\n".repeat(30_000));
    let made = run(&text, &RunOptions::default(), &Job::default()).unwrap();
    assert_eq!(made.warnings.len(), 30_000);
    for (k, warning) in made.warnings.iter().enumerate() {
        assert_eq!(warning.place, (k as u64 + 2, if k == 0 { 4 } else { 3 }));
    }
}

#[test]
fn broken_texts_end_well() {
    let seed = 5;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let text = "r = param('r', 0.4)\ndef hole(a, b=2):\n    c = []\n    for k in range(3):\n        c.append(move(cylinder(r, b), a * k, 0))\n    return union(c) if a > 1 else c[0]\nbox(2, 2, 1) - hole(2) | field(sqrt(x * x + y) - 1.5e0)\n";
    let bytes = text.as_bytes();
    for round in 0..4000 {
        let mut changed = bytes.to_vec();
        for _ in 0..1 + random.below(4) {
            let (i, j) = (random.below(changed.len()), random.below(changed.len()));
            match random.below(4) {
                0 => changed[i] = b"()[]{}:,.=+-*/%|&<>'\"#\\ \n\tafx19"[random.below(31)],
                1 => changed[i] ^= 1 << random.below(8),
                2 => drop(changed.drain(i.min(j)..i.max(j).min(i.min(j) + 20))),
                _ => {
                    let piece: Vec<u8> = changed[i.min(j)..i.max(j).min(i.min(j) + 20)].to_vec();
                    changed.splice(i..i, piece);
                }
            }
            if changed.is_empty() {
                changed = bytes.to_vec();
            }
        }
        let changed = String::from_utf8_lossy(&changed).into_owned();
        let outcome =
            std::panic::catch_unwind(|| run(&changed, &RunOptions::default(), &Job::default()).err());
        let Ok(error) = outcome else { panic!("round {round}: {changed:?}") };
        assert!(error.is_none_or(|error| !error.message.is_empty() && !error.code.is_empty()));
    }
}
