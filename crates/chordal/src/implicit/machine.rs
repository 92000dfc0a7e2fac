//! Running a program: block by block, each step a loop over a block.
use super::block::{Claims, Lane, MOST_CLAIMS, all_near, at_most, put};
use super::number::is_periodic;
use super::op::{Binary, Unary};
use super::program::{Code, Program, Step, VectorOp};
use crate::math::simd::{self, Kernel};
use std::any::Any;
use std::cell::RefCell;

/// A program with where its inputs come from and where its results go.
pub(super) struct Run<'a, N: Lane, F, G> {
    pub(super) program: &'a Program,
    pub(super) rows: usize,
    /// The coordinate `k` of a row.
    pub(super) axis: F,
    /// The values of leaves: the inputs behind the three coordinates.
    pub(super) columns: &'a [Vec<N>],
    /// Takes the output `k` of a row.
    pub(super) put: G,
}

impl<N: Lane, F: Fn(usize, usize) -> N, G: FnMut(usize, usize, N)> Run<'_, N, F, G> {
    /// Runs it, the steps on the processor's best instruction set.
    ///
    /// Inputs and outputs stay outside of what is compiled for each set: the steps then know of no closure,
    /// and there is one copy of them for each kind of number and not one for each way of asking.
    pub(super) fn dispatch(mut self) {
        let program = self.program;
        let mut machine = Machine::<N>::of_thread(program);
        let mut start = 0;
        while start < self.rows {
            let left = self.rows - start;
            let n = if left < N::LANES { left } else { N::LANES };
            let mut claims = [u64::MAX; MOST_CLAIMS];
            for (input, read) in program.reads.iter().enumerate() {
                if !read {
                    continue;
                }
                let block = &mut machine.inputs[input];
                // Each coordinate has a loop of its own, in which the compiler knows which one it is.
                macro_rules! axis {
                    ($k:literal) => {
                        for at in 0..at_most::<N>(n) {
                            put((self.axis)($k, start + at), block, &mut claims, at);
                        }
                    };
                }
                match input {
                    0 => axis!(0),
                    1 => axis!(1),
                    2 => axis!(2),
                    _ => {
                        for (at, value) in self.columns[input - 3][start..start + n].iter().enumerate() {
                            put(*value, block, &mut claims, at);
                        }
                    }
                }
            }
            simd::dispatch(simd::isa(), Steps { program, n, machine: &mut machine, claims: &mut claims });
            for (k, output) in program.outputs.iter().enumerate() {
                let block = machine.operand(*output);
                for at in 0..n {
                    (self.put)(k, start + at, N::load(block, at).settled(kept::<N>(&claims, at)));
                }
            }
            start += n;
        }
        machine.give_back();
    }
}

/// The steps of a program over one block.
struct Steps<'a, N: Lane> {
    program: &'a Program,
    n: usize,
    machine: &'a mut Machine<N>,
    claims: &'a mut Claims,
}

impl<N: Lane> Kernel for Steps<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for step in &self.program.steps {
            self.machine.step(self.n, step, self.claims);
        }
    }
}

/// What is left of one claim.
#[inline(always)]
fn kept<N: Lane>(claims: &Claims, at: usize) -> u64 {
    if N::CLAIMS { claims[at] } else { u64::MAX }
}

thread_local! {
    /// One machine of each type of number, while no call uses it.
    static KEPT: RefCell<Vec<Box<dyn Any>>> = const { RefCell::new(Vec::new()) };
}

/// Registers that are kept between calls at the most: some megabytes.
const MOST_KEPT: usize = 1024;

struct Machine<N: Lane> {
    inputs: Vec<N::Block>,
    /// Boxed, so that a result is put in its place by swapping pointers: it may be written where an operand was.
    registers: Vec<Box<N::Block>>,
    spare: Box<N::Block>,
    number: Box<N::Block>,
}

impl<N: Lane> Machine<N> {
    /// The thread's last one, with room for a program: calls of a few points would spend most of their time
    /// on getting memory. What is left in it changes nothing, since programs write before they read.
    #[inline(never)]
    fn of_thread(program: &Program) -> Box<Self> {
        let kept = KEPT.with_borrow_mut(|kept| {
            let at = kept.iter().position(|machine| machine.is::<Self>())?;
            kept.swap_remove(at).downcast::<Self>().ok()
        });
        let mut machine = kept.unwrap_or_else(|| {
            let (spare, number) = (Box::new(N::block()), Box::new(N::block()));
            Box::new(Self { inputs: Vec::new(), registers: Vec::new(), spare, number })
        });
        machine.inputs.resize_with(program.n_inputs, N::block);
        let registers = machine.registers.len().max(program.n_registers);
        machine.registers.resize_with(registers, || Box::new(N::block()));
        machine
    }

    /// Keeps it for the thread's next call, unless it is large.
    #[inline(never)]
    fn give_back(self: Box<Self>) {
        if self.registers.len() <= MOST_KEPT {
            KEPT.with_borrow_mut(|kept| kept.push(self));
        }
    }

    #[inline(always)]
    fn operand(&self, operand: u32) -> &N::Block {
        find::<N>(&self.inputs, &self.registers, operand)
    }

    #[inline(always)]
    fn step(&mut self, n: usize, step: &Step, claims: &mut Claims) {
        let Self { inputs, registers, spare, number } = self;
        let a = find::<N>(inputs, registers, step.a);
        let constant = N::constant(step.number);
        match step.code {
            Code::Const => constant_block::<N>(n, spare, claims, constant),
            Code::Unary(op) => unary::<N>(op, n, spare, a, claims),
            Code::Binary(op) => {
                let b = find::<N>(inputs, registers, step.b);
                binary::<N, _, _>(op, n, spare, claims, (Each::<N>(a), Each::<N>(b)));
            }
            Code::Vector2(op) => {
                vector::<N, 2>(op, n, spare, claims, [a, find::<N>(inputs, registers, step.b)]);
            }
            Code::Vector3(op) => {
                let [b, c] = [step.b, step.c].map(|of| find::<N>(inputs, registers, of));
                vector::<N, 3>(op, n, spare, claims, [a, b, c]);
            }
            Code::WithConst(op) if !N::IMMEDIATE => {
                constant_block::<N>(n, number, claims, constant);
                binary::<N, _, _>(op, n, spare, claims, (Each::<N>(a), Each::<N>(number)));
            }
            Code::ConstWith(op) if !N::IMMEDIATE => {
                constant_block::<N>(n, number, claims, constant);
                binary::<N, _, _>(op, n, spare, claims, (Each::<N>(number), Each::<N>(a)));
            }
            Code::WithConst(op) => binary::<N, _, _>(op, n, spare, claims, (Each::<N>(a), Same(constant))),
            Code::ConstWith(op) => binary::<N, _, _>(op, n, spare, claims, (Same(constant), Each::<N>(a))),
        }
        std::mem::swap(spare, &mut registers[step.out as usize]);
    }
}

#[inline(always)]
fn find<'a, N: Lane>(inputs: &'a [N::Block], registers: &'a [Box<N::Block>], operand: u32) -> &'a N::Block {
    let operand = operand as usize;
    match operand.checked_sub(inputs.len()) {
        None => &inputs[operand],
        Some(register) => &registers[register],
    }
}

#[inline(always)]
fn constant_block<N: Lane>(n: usize, out: &mut N::Block, claims: &mut Claims, value: N) {
    for at in 0..at_most::<N>(n) {
        put(value, out, claims, at);
    }
}

#[inline(always)]
fn vector<N: Lane, const D: usize>(
    op: VectorOp,
    n: usize,
    out: &mut N::Block,
    claims: &mut Claims,
    parts: [&N::Block; D],
) {
    for at in 0..at_most::<N>(n) {
        let coordinates = parts.map(|part| N::load(part, at));
        let value = match op {
            VectorOp::Length => N::length(coordinates),
            VectorOp::BoxDistance => N::box_distance(coordinates),
        };
        put(value, out, claims, at);
    }
}

/// An operand of a loop over a block; closures would not be sure to be inlined into it.
trait Operand<N> {
    fn get(&self, at: usize) -> N;
}

/// A block's values.
struct Each<'a, N: Lane>(&'a N::Block);

impl<N: Lane> Operand<N> for Each<'_, N> {
    #[inline(always)]
    fn get(&self, at: usize) -> N {
        N::load(self.0, at)
    }
}

/// One value.
struct Same<N>(N);

impl<N: Lane> Operand<N> for Same<N> {
    #[inline(always)]
    fn get(&self, _: usize) -> N {
        self.0
    }
}

/// One operation over a block. Each is a loop of its own, with the operation known to the compiler.
#[inline(always)]
fn unary<N: Lane>(op: Unary, n: usize, out: &mut N::Block, a: &N::Block, claims: &mut Claims) {
    if is_periodic(op) && !all_near::<N>(n, a) {
        return unary_anywhere::<N>(op, n, out, a, claims);
    }
    macro_rules! each {
        ($($name:ident)*) => {
            match op {
                $(Unary::$name => for at in 0..at_most::<N>(n) {
                    put(N::near(Unary::$name, N::load(a, at)), out, claims, at);
                })*
            }
        };
    }
    each!(Neg Abs Recip Sqrt Square Floor Ceil Round Sin Cos Tan Asin Acos Atan Exp Ln Not);
}

/// Sine, cosine or tangent of any angles.
#[inline(never)]
fn unary_anywhere<N: Lane>(op: Unary, n: usize, out: &mut N::Block, a: &N::Block, claims: &mut Claims) {
    for at in 0..at_most::<N>(n) {
        put(N::unary(op, N::load(a, at)), out, claims, at);
    }
}

/// As [`unary`], with two operands.
#[inline(always)]
fn binary<N: Lane, A: Operand<N>, B: Operand<N>>(
    op: Binary,
    n: usize,
    out: &mut N::Block,
    claims: &mut Claims,
    (a, b): (A, B),
) {
    macro_rules! each {
        ($($name:ident)*) => {
            match op {
                $(Binary::$name => for at in 0..at_most::<N>(n) {
                    put(N::binary(Binary::$name, a.get(at), b.get(at)), out, claims, at);
                })*
            }
        };
    }
    each!(Add Sub Mul Div Min Max SmoothMin LogSumExp Atan2 Mod Compare And Or);
}
