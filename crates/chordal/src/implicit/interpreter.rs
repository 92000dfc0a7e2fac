//! The interpreter of programs: block by block, each step a loop over a block.
use super::block::{BlockScalar, Decorations, MOST_CLAIMS, all_near, at_most, put};
use super::number::is_periodic;
use super::op::{Binary, Unary};
use super::program::{Instruction, Opcode, Program, VectorOp};
use crate::math::lesser;
use crate::math::simd::{self, Kernel};
use std::any::Any;
use std::cell::RefCell;

/// A program with the sources of its inputs and the destination of its results.
pub(super) struct ProgramRun<'a, N: BlockScalar, F, G> {
    pub(super) program: &'a Program,
    pub(super) rows: usize,
    /// The coordinate `k` of a row.
    pub(super) axis: F,
    /// The values of leaves: the inputs after the three coordinates.
    pub(super) columns: &'a [Vec<N>],
    /// Receives the output `k` of a row.
    pub(super) put: G,
}

impl<N: BlockScalar, F: Fn(usize, usize) -> N, G: FnMut(usize, usize, N)> ProgramRun<'_, N, F, G> {
    /// Runs the steps on the processor's best instruction set.
    ///
    /// Inputs and outputs stay outside the code that is compiled for each instruction set. So the steps
    /// contain no closures, and there is one copy of them per kind of number, not one per kind of query.
    pub(super) fn dispatch(mut self) {
        let program = self.program;
        let mut machine = BlockInterpreter::<N>::take_cached(program);
        let mut start = 0;
        while start < self.rows {
            let remaining = self.rows - start;
            let n = lesser(remaining, N::LANES);
            let mut claims = [u64::MAX; MOST_CLAIMS];
            for (input, read) in program.reads.iter().enumerate() {
                if !read {
                    continue;
                }
                let block = &mut machine.inputs[input];
                // Each coordinate has its own loop, in which its index is a constant.
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
            simd::dispatch(
                simd::isa(),
                BlockKernel { program, n, machine: &mut machine, claims: &mut claims },
            );
            for (k, output) in program.outputs.iter().enumerate() {
                let block = machine.operand(*output);
                for at in 0..n {
                    (self.put)(
                        k,
                        start + at,
                        N::load(block, at).with_decoration(decoration_at::<N>(&claims, at)),
                    );
                }
            }
            start += n;
        }
        machine.cache();
    }
}

/// The steps of a program over one block.
struct BlockKernel<'a, N: BlockScalar> {
    program: &'a Program,
    n: usize,
    machine: &'a mut BlockInterpreter<N>,
    claims: &'a mut Decorations,
}

impl<N: BlockScalar> Kernel for BlockKernel<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for step in &self.program.steps {
            self.machine.step(self.n, step, self.claims);
        }
    }
}

/// The decoration of one number after all steps.
#[inline(always)]
fn decoration_at<N: BlockScalar>(claims: &Decorations, at: usize) -> u64 {
    if N::CLAIMS { claims[at] } else { u64::MAX }
}

thread_local! {
    /// One interpreter for each type of number, cached while no call uses it.
    static CACHE: RefCell<Vec<Box<dyn Any>>> = const { RefCell::new(Vec::new()) };
}

/// The most registers of a cached interpreter: some megabytes.
const MOST_CACHED: usize = 1024;

struct BlockInterpreter<N: BlockScalar> {
    inputs: Vec<N::Block>,
    /// Boxed, so that a result is stored by swapping pointers: its register may have held an operand.
    registers: Vec<Box<N::Block>>,
    spare: Box<N::Block>,
    number: Box<N::Block>,
}

impl<N: BlockScalar> BlockInterpreter<N> {
    /// The thread's last interpreter, enlarged for a program: calls for a few points would spend most of
    /// their time on allocation. Old contents do not matter, because programs write registers before they
    /// read them.
    #[inline(never)]
    fn take_cached(program: &Program) -> Box<Self> {
        let cached = CACHE.with_borrow_mut(|cache| {
            let at = cache.iter().position(|machine| machine.is::<Self>())?;
            cache.swap_remove(at).downcast::<Self>().ok()
        });
        let mut machine = cached.unwrap_or_else(|| {
            let (spare, number) = (Box::new(N::block()), Box::new(N::block()));
            Box::new(Self { inputs: Vec::new(), registers: Vec::new(), spare, number })
        });
        // Exactly as many as the program has: operands from there on are registers.
        machine.inputs.resize_with(program.n_inputs, N::block);
        let registers = machine.registers.len().max(program.n_registers);
        machine.registers.resize_with(registers, || Box::new(N::block()));
        machine
    }

    /// Caches it for the thread's next call, unless it is large.
    #[inline(never)]
    fn cache(self: Box<Self>) {
        if self.registers.len() <= MOST_CACHED {
            CACHE.with_borrow_mut(|cache| cache.push(self));
        }
    }

    #[inline(always)]
    fn operand(&self, operand: u32) -> &N::Block {
        find::<N>(&self.inputs, &self.registers, operand)
    }

    #[inline(always)]
    fn step(&mut self, n: usize, step: &Instruction, claims: &mut Decorations) {
        let Self { inputs, registers, spare, number } = self;
        let a = find::<N>(inputs, registers, step.a);
        let constant = N::constant(step.number);
        match step.code {
            Opcode::Const => constant_block::<N>(n, spare, claims, constant),
            Opcode::Unary(op) => unary::<N>(op, n, spare, a, claims),
            Opcode::Binary(op) => {
                let b = find::<N>(inputs, registers, step.b);
                binary::<N, _, _>(op, n, spare, claims, BlockValues::<N>(a), BlockValues::<N>(b));
            }
            Opcode::Vector2(op) => {
                vector::<N, 2>(op, n, spare, claims, [a, find::<N>(inputs, registers, step.b)]);
            }
            Opcode::Vector3(op) => {
                let [b, c] = [step.b, step.c].map(|operand| find::<N>(inputs, registers, operand));
                vector::<N, 3>(op, n, spare, claims, [a, b, c]);
            }
            Opcode::WithConst(op) if !N::IMMEDIATE => {
                constant_block::<N>(n, number, claims, constant);
                binary::<N, _, _>(op, n, spare, claims, BlockValues::<N>(a), BlockValues::<N>(number));
            }
            Opcode::ConstWith(op) if !N::IMMEDIATE => {
                constant_block::<N>(n, number, claims, constant);
                binary::<N, _, _>(op, n, spare, claims, BlockValues::<N>(number), BlockValues::<N>(a));
            }
            Opcode::WithConst(op) => {
                binary::<N, _, _>(op, n, spare, claims, BlockValues::<N>(a), Broadcast(constant))
            }
            Opcode::ConstWith(op) => {
                binary::<N, _, _>(op, n, spare, claims, Broadcast(constant), BlockValues::<N>(a))
            }
        }
        // The register may hold an operand, so the result is written beside it.
        std::mem::swap(spare, &mut registers[step.out as usize]);
    }
}

#[inline(always)]
fn find<'a, N: BlockScalar>(
    inputs: &'a [N::Block],
    registers: &'a [Box<N::Block>],
    operand: u32,
) -> &'a N::Block {
    let operand = operand as usize;
    match operand.checked_sub(inputs.len()) {
        None => &inputs[operand],
        Some(register) => &registers[register],
    }
}

#[inline(always)]
fn constant_block<N: BlockScalar>(n: usize, out: &mut N::Block, claims: &mut Decorations, value: N) {
    for at in 0..at_most::<N>(n) {
        put(value, out, claims, at);
    }
}

#[inline(always)]
fn vector<N: BlockScalar, const D: usize>(
    op: VectorOp,
    n: usize,
    out: &mut N::Block,
    claims: &mut Decorations,
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

/// An operand of a loop over a block. A closure might not be inlined into the loop.
trait BlockOperand<N> {
    fn get(&self, at: usize) -> N;
}

/// A block's values.
struct BlockValues<'a, N: BlockScalar>(&'a N::Block);

impl<N: BlockScalar> BlockOperand<N> for BlockValues<'_, N> {
    #[inline(always)]
    fn get(&self, at: usize) -> N {
        N::load(self.0, at)
    }
}

/// One value.
struct Broadcast<N>(N);

impl<N: BlockScalar> BlockOperand<N> for Broadcast<N> {
    #[inline(always)]
    fn get(&self, _: usize) -> N {
        self.0
    }
}

/// One operation over a block. Each operation has its own loop, in which the compiler knows it.
#[inline(always)]
fn unary<N: BlockScalar>(op: Unary, n: usize, out: &mut N::Block, a: &N::Block, claims: &mut Decorations) {
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

/// Sine, cosine or tangent of angles of any size.
#[inline(never)]
fn unary_anywhere<N: BlockScalar>(
    op: Unary,
    n: usize,
    out: &mut N::Block,
    a: &N::Block,
    claims: &mut Decorations,
) {
    for at in 0..at_most::<N>(n) {
        put(N::unary(op, N::load(a, at)), out, claims, at);
    }
}

/// Like [`unary`], with two operands.
#[inline(always)]
fn binary<N: BlockScalar, A: BlockOperand<N>, B: BlockOperand<N>>(
    op: Binary,
    n: usize,
    out: &mut N::Block,
    claims: &mut Decorations,
    a: A,
    b: B,
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
    each!(Add Sub Mul Div Min Max SmoothMin RoundMin LogSumExp Atan2 Mod Compare And Or);
}
