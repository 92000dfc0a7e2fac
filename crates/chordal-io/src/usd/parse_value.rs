//! Values of USD's text form: numbers in tuples and lists, words, and skipped values.
use super::layer::too_deep;
use super::scanner::UsdaScanner;
use super::value::{UsdNumbers, UsdType, UsdValue};
use crate::ReadError;
use crate::grow::push;
use crate::text::{number, number_error};

impl UsdaScanner<'_> {
    /// The value of an attribute of a type.
    pub(super) fn value(&mut self, kind: UsdType, depth: usize) -> Result<UsdValue, ReadError> {
        if self.peek_word()? == "None" {
            self.word()?;
            return Ok(UsdValue::Blocked);
        }
        if kind.is_words {
            return self.words(kind).map(UsdValue::Words);
        }
        if kind.width == 0 {
            self.skip_value(depth)?;
            return Ok(UsdValue::Other);
        }
        self.numbers(kind).map(UsdValue::Numbers)
    }

    fn numbers(&mut self, kind: UsdType) -> Result<UsdNumbers, ReadError> {
        let mut numbers = UsdNumbers { width: usize::from(kind.width), values: Vec::new() };
        if !kind.is_array {
            self.element(&mut numbers)?;
            return Ok(numbers);
        }
        self.need(b'[')?;
        while !self.take(b']')? {
            self.element(&mut numbers)?;
            if !self.take(b',')? && self.peek()? != b']' {
                return Err(self.expected("',' or ']'"));
            }
        }
        Ok(numbers)
    }

    /// A number, or as many as the type has, in brackets; matrices have nested brackets.
    fn element(&mut self, numbers: &mut UsdNumbers) -> Result<(), ReadError> {
        if numbers.width == 1 {
            return self.number_into(numbers);
        }
        let before = numbers.values.len();
        let mut open = 0;
        loop {
            match self.peek()? {
                b'(' => open += 1,
                b')' if open > 0 => open -= 1,
                b',' if open > 0 => {}
                _ if open > 0 => {
                    self.number_into(numbers)?;
                    continue;
                }
                _ => return Err(self.expected("'('")),
            }
            self.at += 1;
            if open == 0 {
                break;
            }
        }
        let n_numbers = numbers.values.len() - before;
        if n_numbers == numbers.width {
            return Ok(());
        }
        let message = format!("a value has {n_numbers} numbers where its type has {}", numbers.width);
        Err(self.error("wrong-count", message))
    }

    fn number_into(&mut self, numbers: &mut UsdNumbers) -> Result<(), ReadError> {
        let word = self.word()?;
        let value = match word {
            "" => return Err(self.expected("a number")),
            "true" | "True" => 1.0,
            "false" | "False" => 0.0,
            _ => number(word.as_bytes())
                .ok_or_else(|| self.error("not-a-number", number_error(word.as_bytes())))?,
        };
        push(&mut numbers.values, value)
    }

    fn words(&mut self, kind: UsdType) -> Result<Vec<Box<str>>, ReadError> {
        let mut words = Vec::new();
        if !kind.is_array {
            words.push(self.one_word()?);
            return Ok(words);
        }
        self.need(b'[')?;
        while !self.take(b']')? {
            let word = self.one_word()?;
            push(&mut words, word)?;
            if !self.take(b',')? && self.peek()? != b']' {
                return Err(self.expected("',' or ']'"));
            }
        }
        Ok(words)
    }

    /// A string, or the path of a file.
    pub(super) fn one_word(&mut self) -> Result<Box<str>, ReadError> {
        if self.peek()? == b'@' { Ok(self.asset()?.into()) } else { Ok(self.string()?.into()) }
    }

    /// Skips a value of any type.
    pub(super) fn skip_value(&mut self, depth: usize) -> Result<(), ReadError> {
        match self.peek()? {
            b'"' | b'\'' => self.string().map(|_| ()),
            b'@' => {
                self.asset()?;
                if self.peek()? == b'<' {
                    self.path()?;
                }
                self.skip_brackets_of_arc(depth)
            }
            b'<' => {
                self.path()?;
                self.skip_brackets_of_arc(depth)
            }
            b'(' | b'[' | b'{' => self.skip_brackets(depth),
            _ if !self.word()?.is_empty() => Ok(()),
            _ => Err(self.expected("a value")),
        }
    }

    /// Skips an optional time offset after an arc.
    pub(super) fn skip_brackets_of_arc(&mut self, depth: usize) -> Result<(), ReadError> {
        if self.peek()? == b'(' { self.skip_brackets(depth) } else { Ok(()) }
    }

    /// Skips brackets of any kind and their content.
    pub(super) fn skip_brackets(&mut self, depth: usize) -> Result<(), ReadError> {
        let mut open = Vec::new();
        loop {
            let byte = self.peek()?;
            match byte {
                b'(' => open.push(b')'),
                b'[' => open.push(b']'),
                b'{' => open.push(b'}'),
                b')' | b']' | b'}' => {
                    if open.pop() != Some(byte) {
                        return Err(self.expected("a value or the other bracket"));
                    }
                }
                // Texts, assets and paths may have brackets in them, which close nothing here.
                b'"' | b'\'' => {
                    self.string()?;
                    continue;
                }
                b'@' => {
                    self.asset()?;
                    continue;
                }
                b'<' => {
                    self.path()?;
                    continue;
                }
                b',' | b'=' => {}
                _ if !self.word()?.is_empty() => continue,
                _ => return Err(self.expected("a value")),
            }
            self.at += 1;
            if open.is_empty() {
                return Ok(());
            }
            if open.len() > depth {
                return Err(too_deep(depth, self.place()));
            }
        }
    }
}
