//! `Program`: terms compiled to steps over registers.
use super::graph::Term;
use super::op::{Binary, Unary};

/// The operation of a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Opcode {
    /// Loads the number.
    Const,
    Unary(Unary),
    Binary(Binary),
    /// An operation on `a` and the number.
    WithConst(Binary),
    /// An operation on the number and `a`, in this order.
    ConstWith(Binary),
    /// An operation on a vector of two operands.
    Vector2(VectorOp),
    /// An operation on a vector of three operands.
    Vector3(VectorOp),
}

/// Several terms of an expression that run as one step: its slope has tighter intervals than the single terms
/// give.
#[derive(Clone, Copy, Debug)]
pub(super) enum VectorOp {
    /// The length of a vector: a root of a sum of squares.
    Length,
    /// The distance to a box, from the signed distances to its sides: `|max(v, 0)| + min(max of v, 0)`.
    BoxDistance,
}

/// One step. Operands below the number of inputs are inputs, the others are registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instruction {
    pub(super) code: Opcode,
    /// The register for the result.
    pub(super) out: u32,
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) c: u32,
    pub(super) number: f64,
}

/// Steps that compute some terms from inputs: x, y, z and the values of leaves.
#[derive(Clone, Debug)]
pub(super) struct Program {
    pub(super) steps: Vec<Instruction>,
    pub(super) n_inputs: usize,
    pub(super) n_registers: usize,
    /// Which inputs are read.
    pub(super) reads: Vec<bool>,
    /// Operands that hold the results.
    pub(super) outputs: Vec<u32>,
}

/// Marks a term without a register or input, or without a use.
const NOWHERE: u32 = u32::MAX;

struct ProgramBuilder<'a> {
    terms: &'a [Term],
    /// The last term that uses each term; the number of terms for outputs.
    last_use: Vec<u32>,
    /// The operand that holds each term's value.
    operand_of: Vec<u32>,
    /// Free registers; the one used last is taken first.
    free: Vec<u32>,
    program: Program,
}

impl Program {
    /// Compiles the terms `outputs`. `leaf_input` returns the input with the value of a leaf's term. A
    /// register is reused after the last use of its value (linear scan). Time and memory: linear.
    pub(super) fn compile(
        terms: &[Term],
        outputs: &[u32],
        leaf_input: &dyn Fn(u32) -> u32,
        n_inputs: usize,
    ) -> Self {
        let last_use = last_uses(terms, outputs);
        let program = Self {
            steps: Vec::new(),
            n_inputs,
            n_registers: 0,
            reads: vec![false; n_inputs],
            outputs: Vec::new(),
        };
        let mut builder = ProgramBuilder {
            terms,
            last_use,
            operand_of: vec![NOWHERE; terms.len()],
            free: Vec::new(),
            program,
        };
        for (k, term) in terms.iter().enumerate() {
            if builder.last_use[k] != NOWHERE {
                builder.term(k as u32, term, leaf_input);
            }
        }
        for output in outputs {
            let operand = builder.operand(*output);
            builder.program.outputs.push(operand);
        }
        builder.program
    }
}

/// For each term the last one that uses it: [`NOWHERE`] if none does, the number of terms for an output.
fn last_uses(terms: &[Term], outputs: &[u32]) -> Vec<u32> {
    let mut last = vec![NOWHERE; terms.len()];
    for output in outputs {
        last[*output as usize] = terms.len() as u32;
    }
    // From the last term on, so that the first use that is found is the last one.
    for (k, term) in terms.iter().enumerate().rev() {
        if last[k] == NOWHERE {
            continue;
        }
        let mut need = |part: u32| {
            if last[part as usize] == NOWHERE {
                last[part as usize] = k as u32;
            }
        };
        operands(terms, term).into_iter().for_each(&mut need);
    }
    last
}

/// The terms that the step of a term reads.
fn operands(terms: &[Term], term: &Term) -> Operands {
    match term {
        Term::Unary(_, a) => length_operands(terms, term).unwrap_or(Operands::new([*a])),
        Term::Binary(_, a, b) => box_distance_operands(terms, term).unwrap_or(Operands::new([*a, *b])),
        // A leaf's value is an input.
        Term::Const(_) | Term::Axis(_) | Term::Leaf(..) => Operands::new([]),
    }
}

/// Up to three terms.
#[derive(Clone, Copy)]
struct Operands {
    terms: [u32; 3],
    n: usize,
}

impl Operands {
    fn new<const N: usize>(terms: [u32; N]) -> Self {
        Self { terms: std::array::from_fn(|k| terms.get(k).copied().unwrap_or(NOWHERE)), n: N }
    }
}

impl IntoIterator for Operands {
    type Item = u32;
    type IntoIter = std::iter::Take<std::array::IntoIter<u32, 3>>;

    fn into_iter(self) -> Self::IntoIter {
        self.terms.into_iter().take(self.n)
    }
}

/// The coordinates of a vector, if the term is its length: a root of a sum of two or three squares.
fn length_operands(terms: &[Term], term: &Term) -> Option<Operands> {
    let Term::Unary(Unary::Sqrt, sum) = term else { return None };
    let sum_of = |term: u32| match terms[term as usize] {
        Term::Binary(Binary::Add, a, b) => Some([a, b]),
        _ => None,
    };
    let square_of = |term: u32| match terms[term as usize] {
        Term::Unary(Unary::Square, a) => Some(a),
        _ => None,
    };
    let [a, b] = sum_of(*sum)?;
    match (square_of(a), square_of(b)) {
        (Some(a), Some(b)) => Some(Operands::new([a, b])),
        (Some(other), None) | (None, Some(other)) => {
            // The two squares in the inner sum are added first on either side of the outer one.
            let [p, q] = sum_of(if square_of(a).is_some() { b } else { a })?;
            Some(Operands::new([square_of(p)?, square_of(q)?, other]))
        }
        (None, None) => None,
    }
}

/// The signed distances to the sides of a box, if the term is the distance to the box.
fn box_distance_operands(terms: &[Term], term: &Term) -> Option<Operands> {
    let Term::Binary(Binary::Add, a, b) = term else { return None };
    let (outside, inside) = match (&terms[*a as usize], &terms[*b as usize]) {
        (root @ Term::Unary(Unary::Sqrt, _), inside) => (root, inside),
        (inside, root @ Term::Unary(Unary::Sqrt, _)) => (root, inside),
        _ => return None,
    };
    let is_zero = |term: u32| matches!(terms[term as usize], Term::Const(k) if k == 0.0);
    let mut sides = length_operands(terms, outside)?;
    for side in &mut sides.terms[..sides.n] {
        match terms[*side as usize] {
            Term::Binary(Binary::Max, a, zero) if is_zero(zero) => *side = a,
            _ => return None,
        }
    }
    let largest = match inside {
        Term::Binary(Binary::Min, a, zero) if is_zero(*zero) => *a,
        _ => return None,
    };
    let mut maxima = Vec::with_capacity(3);
    let mut open = vec![largest];
    while let Some(term) = open.pop() {
        match terms[term as usize] {
            // A side may be a maximum itself, which is not opened.
            Term::Binary(Binary::Max, a, b) if !sides.into_iter().any(|side| side == term) => {
                open.extend([a, b]);
            }
            _ => maxima.push(term),
        }
        // Each open term gives at least one more operand.
        if maxima.len() + open.len() > sides.n {
            return None;
        }
    }
    let mut side_terms: Vec<u32> = sides.into_iter().collect();
    maxima.sort_unstable();
    side_terms.sort_unstable();
    (maxima == side_terms).then_some(sides)
}

/// The terms between the distance to a box and the distances to its sides. They are one step as long as none
/// of them changes.
pub(super) fn box_distance_terms(terms: &[Term], term: &Term) -> Vec<u32> {
    let (Some(sides), Term::Binary(_, a, b)) = (box_distance_operands(terms, term), term) else {
        return Vec::new();
    };
    let mut between = Vec::new();
    let mut open = vec![*a, *b];
    while let Some(part) = open.pop() {
        if !sides.into_iter().any(|side| side == part) {
            between.push(part);
            open.extend(super::graph::parts(&terms[part as usize]));
        }
    }
    between
}

impl ProgramBuilder<'_> {
    fn term(&mut self, k: u32, term: &Term, leaf_input: &dyn Fn(u32) -> u32) {
        let step = |code, a, b, number| Instruction { code, out: 0, a, b, c: 0, number };
        let instruction = match term {
            Term::Const(_) => return,
            Term::Axis(axis) => return self.input(k, u32::from(*axis)),
            Term::Leaf(..) => return self.input(k, leaf_input(k)),
            Term::Unary(op, a) => match length_operands(self.terms, term) {
                Some(parts) => self.vector_instruction(VectorOp::Length, parts),
                None => step(Opcode::Unary(*op), self.operand(*a), 0, 0.0),
            },
            Term::Binary(op, a, b) => match box_distance_operands(self.terms, term) {
                Some(sides) => self.vector_instruction(VectorOp::BoxDistance, sides),
                None => match (&self.terms[*a as usize], &self.terms[*b as usize]) {
                    (Term::Const(number), Term::Const(_)) => {
                        step(Opcode::ConstWith(*op), self.operand(*b), 0, *number)
                    }
                    (_, Term::Const(number)) => step(Opcode::WithConst(*op), self.operand(*a), 0, *number),
                    (Term::Const(number), _) => step(Opcode::ConstWith(*op), self.operand(*b), 0, *number),
                    _ => step(Opcode::Binary(*op), self.operand(*a), self.operand(*b), 0.0),
                },
            },
        };
        // Released first, so that the result may take the register of an operand: the interpreter stores it
        // by a swap.
        for part in operands(self.terms, term) {
            self.release(part, k);
        }
        let out = self.register();
        self.operand_of[k as usize] = out + self.program.n_inputs as u32;
        self.program.steps.push(Instruction { out, ..instruction });
    }

    /// A step with two or three operands.
    fn vector_instruction(&mut self, op: VectorOp, Operands { terms, n }: Operands) -> Instruction {
        let [a, b] = [terms[0], terms[1]].map(|part| self.operand(part));
        let (code, c) = match n {
            3 => (Opcode::Vector3(op), self.operand(terms[2])),
            _ => (Opcode::Vector2(op), 0),
        };
        Instruction { code, out: 0, a, b, c, number: 0.0 }
    }

    fn input(&mut self, k: u32, input: u32) {
        self.operand_of[k as usize] = input;
        self.program.reads[input as usize] = true;
    }

    fn register(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.program.n_registers += 1;
            self.program.n_registers as u32 - 1
        })
    }

    /// The operand with a term's value. A constant used as an operand gets its own register.
    fn operand(&mut self, term: u32) -> u32 {
        if let (NOWHERE, Term::Const(number)) = (self.operand_of[term as usize], &self.terms[term as usize]) {
            let out = self.register();
            self.operand_of[term as usize] = out + self.program.n_inputs as u32;
            self.program.steps.push(Instruction {
                code: Opcode::Const,
                out,
                a: 0,
                b: 0,
                c: 0,
                number: *number,
            });
        }
        self.operand_of[term as usize]
    }

    /// Frees a register after its last use, which is at term `k`.
    fn release(&mut self, term: u32, k: u32) {
        let operand = self.operand_of[term as usize];
        if self.last_use[term as usize] == k && operand != NOWHERE && operand >= self.program.n_inputs as u32
        {
            self.free.push(operand - self.program.n_inputs as u32);
            self.operand_of[term as usize] = NOWHERE;
        }
    }
}
