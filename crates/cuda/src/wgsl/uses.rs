//! How often each expression of a function is written, if all of them are written out.

use naga::{AtomicFunction, Block, Expression, Function, Handle, Statement, TypeInner};
use std::collections::HashMap;

/// Of each expression that anything needs, how often it is.
#[derive(Debug, Default)]
pub(super) struct Uses {
    counts: HashMap<Handle<Expression>, u32>,
}

impl Uses {
    /// Of a function, and of each of its expressions whether it is a vector.
    pub fn new(function: &Function, is_vector: impl Fn(Handle<Expression>) -> bool) -> Self {
        let mut uses = Self::default();
        uses.block(&function.body);
        // Operands come before what needs them.
        for (handle, expression) in function.expressions.iter().rev() {
            if uses.count(handle) > 0 {
                uses.operands(expression, &is_vector);
            }
        }
        uses
    }

    pub fn count(&self, handle: Handle<Expression>) -> u32 {
        self.counts.get(&handle).copied().unwrap_or(0)
    }

    fn add(&mut self, handle: Handle<Expression>) {
        *self.counts.entry(handle).or_default() += 1;
    }

    fn add_all(&mut self, handles: impl IntoIterator<Item = Handle<Expression>>) {
        handles.into_iter().for_each(|handle| self.add(handle));
    }

    fn operands(
        &mut self,
        expression: &Expression,
        is_vector: impl Fn(Handle<Expression>) -> bool,
    ) {
        match *expression {
            Expression::Compose { ref components, .. } => {
                // Components of a vector are written one by one.
                let vectors = components.iter().filter(|&&it| is_vector(it));
                self.add_all(components.iter().chain(vectors).copied());
            }
            Expression::Swizzle { vector, .. } => self.add_all([vector, vector]),
            Expression::Access { base, index } => self.add_all([base, index]),
            Expression::Binary { left, right, .. } => self.add_all([left, right]),
            Expression::Select {
                condition,
                accept,
                reject,
            } => self.add_all([condition, accept, reject]),
            Expression::Math {
                arg,
                arg1,
                arg2,
                arg3,
                ..
            } => self.add_all([Some(arg), arg1, arg2, arg3].into_iter().flatten()),
            Expression::AccessIndex { base: it, .. }
            | Expression::Splat { value: it, .. }
            | Expression::Load { pointer: it }
            | Expression::Unary { expr: it, .. }
            | Expression::Relational { argument: it, .. }
            | Expression::As { expr: it, .. } => self.add(it),
            // Others have no operands, or are not translated.
            _ => {}
        }
    }

    fn block(&mut self, block: &Block) {
        for statement in block {
            self.statement(statement);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match *statement {
            Statement::Block(ref block) => self.block(block),
            Statement::If {
                condition,
                ref accept,
                ref reject,
            } => {
                self.add(condition);
                self.block(accept);
                self.block(reject);
            }
            Statement::Switch {
                selector,
                ref cases,
            } => {
                self.add(selector);
                for case in cases {
                    self.block(&case.body);
                }
            }
            Statement::Loop {
                ref body,
                ref continuing,
                break_if,
            } => {
                self.block(body);
                self.block(continuing);
                self.add_all(break_if);
            }
            Statement::Return { value } => self.add_all(value),
            Statement::Store { pointer, value } => self.add_all([pointer, value]),
            Statement::Atomic {
                pointer,
                fun,
                value,
                ..
            } => {
                self.add_all([pointer, value]);
                if let AtomicFunction::Exchange { compare } = fun {
                    self.add_all(compare);
                }
            }
            Statement::WorkGroupUniformLoad { pointer, .. } => self.add(pointer),
            Statement::Call { ref arguments, .. } => self.add_all(arguments.iter().copied()),
            // Others need nothing, or are not translated.
            _ => {}
        }
    }
}

pub(super) fn is_vector(inner: &TypeInner) -> bool {
    matches!(inner, TypeInner::Vector { .. })
}
