//! The terms of an expression as statements of a shader: the walk is the same for all languages and for values and
//! derivatives.
use crate::implicit::{Binary, Term, Unary};

/// The text of a term.
#[derive(Clone, Debug)]
pub struct TermText {
    pub text: String,
    /// Whether it needs no parentheses as an operand.
    pub is_atom: bool,
    /// Whether it is a plain number, which has no derivatives.
    pub is_number: bool,
}

impl TermText {
    /// A name, a number or a call.
    pub fn atom(text: impl Into<String>) -> Self {
        Self { text: text.into(), is_atom: true, is_number: false }
    }

    /// An expression with an operator.
    pub fn infix(text: String) -> Self {
        Self { text, is_atom: false, is_number: false }
    }

    /// The text, in parentheses if it has an operator.
    pub fn operand(&self) -> String {
        if self.is_atom { self.text.clone() } else { format!("({})", self.text) }
    }
}

/// A language, and a type of numbers in it.
pub trait ShaderPrinter {
    /// A number of the expression.
    fn number(&self, value: f64) -> TermText;
    /// x, y or z.
    fn axis(&self, axis: u8) -> TermText;
    /// An operation on a term.
    fn unary(&mut self, op: Unary, a: &TermText) -> TermText;
    /// An operation on two terms, at most one of which is a number.
    fn binary(&mut self, op: Binary, a: &TermText, b: &TermText) -> TermText;
    /// The statement that names a value.
    fn declaration(&self, name: &str, value: &str) -> String;
}

/// A longer text gets a name of its own, even if it is used once. Chosen: a line has some hundred characters.
const LONGEST: usize = 64;

/// The length of a text without its numbers, which must not decide what gets a name: other numbers are to leave the
/// statements as they are.
fn length(text: &str) -> usize {
    text.chars().filter(|c| !c.is_ascii_digit() && !matches!(c, '.' | '-' | 'e' | '(' | ')')).count()
}

/// The statements that compute all terms, and the text of the last one. Terms that are used more than once get a name.
/// None if a term is a leaf.
pub fn statements(terms: &[Term], printer: &mut impl ShaderPrinter) -> Option<(Vec<String>, String)> {
    let mut uses = vec![0_u32; terms.len()];
    for term in terms {
        match term {
            Term::Const(_) | Term::Axis(_) => {}
            // Written as a product with itself.
            Term::Unary(Unary::Square, a) => uses[*a as usize] += 2,
            Term::Unary(_, a) => uses[*a as usize] += 1,
            Term::Binary(_, a, b) => [a, b].into_iter().for_each(|part| uses[*part as usize] += 1),
            Term::Leaf(..) => return None,
        }
    }
    let mut lines = Vec::new();
    let mut texts: Vec<TermText> = Vec::with_capacity(terms.len());
    for (k, term) in terms.iter().enumerate() {
        let of = |part: &u32| &texts[*part as usize];
        let is_simple = matches!(term, Term::Const(_) | Term::Axis(_));
        let text = match term {
            Term::Const(value) => printer.number(*value),
            Term::Axis(axis) => printer.axis(*axis),
            Term::Unary(op, a) => printer.unary(*op, of(a)),
            Term::Binary(op, a, b) => printer.binary(*op, of(a), of(b)),
            Term::Leaf(..) => return None,
        };
        let is_last = k + 1 == terms.len();
        let is_named = !is_simple && !is_last && (uses[k] > 1 || length(&text.text) > LONGEST);
        texts.push(if is_named {
            let name = format!("t{}", lines.len());
            lines.push(printer.declaration(&name, &text.text));
            TermText::atom(name)
        } else {
            text
        });
    }
    texts.pop().map(|last| (lines, last.text))
}
