//! What a function does, one statement after the other.
//!
//! naga says at which statement an expression is computed. What is read from memory has a name from there on; what
//! follows from values alone may be written where it is used.

use super::names::Names;
use super::uses::{Uses, is_vector};
use super::{Shader, WgslError, unsupported};
use naga::valid::FunctionInfo;
use naga::{
    AtomicFunction, Barrier, Block, Expression, Function, Handle, LocalVariable, Statement,
    SwitchCase, SwitchValue, TypeInner,
};
use std::collections::HashMap;

type Done = Result<(), WgslError>;

/// A function while its statements are written.
pub(super) struct Body<'a> {
    pub shader: &'a Shader<'a>,
    pub function: &'a Function,
    pub info: &'a FunctionInfo,
    names: Names,
    arguments: Vec<String>,
    locals: HashMap<Handle<LocalVariable>, String>,
    /// Names of values that have been computed; none where they cannot be seen any more.
    values: HashMap<Handle<Expression>, Option<String>>,
    /// Those that were named in each of the blocks around.
    blocks: Vec<Vec<Handle<Expression>>>,
    uses: Uses,
    /// Of each of the loops around, where it goes on, unless at its begin.
    loops: Vec<Option<String>>,
    text: String,
}

impl<'a> Body<'a> {
    pub fn new(shader: &'a Shader<'a>, function: &'a Function, info: &'a FunctionInfo) -> Self {
        let types = &shader.module.types;
        let is_vector = |it: Handle<Expression>| is_vector(info[it].ty.inner_with(types));
        let uses = Uses::new(function, is_vector);
        Self {
            shader,
            function,
            info,
            names: shader.names.clone(),
            arguments: Vec::new(),
            locals: HashMap::new(),
            values: HashMap::new(),
            blocks: Vec::new(),
            uses,
            loops: Vec::new(),
            text: String::new(),
        }
    }

    /// Those of all arguments are asked for in turn.
    pub fn name_argument(&mut self, wish: Option<&str>) -> String {
        let name = self.names.fresh(wish.unwrap_or("argument"));
        self.arguments.push(name.clone());
        name
    }

    /// Variables and statements.
    pub fn print(mut self) -> Result<String, WgslError> {
        self.blocks.push(Vec::new());
        for (handle, local) in self.function.local_variables.iter() {
            let name = self.names.fresh(local.name.as_deref().unwrap_or("local"));
            let ty = self.shader.type_name(local.ty)?;
            let value = match local.init {
                Some(value) => self.value(value)?,
                None => self.shader.zero(local.ty)?,
            };
            self.line(&format!("{ty} {name} = {value};"));
            self.locals.insert(handle, name);
        }
        let statements = &self.function.body[..];
        let statements = match statements {
            [before @ .., Statement::Return { value: None }] => before,
            all => all,
        };
        self.statements(statements)?;
        Ok(self.text)
    }

    pub(super) fn argument(&self, index: u32) -> Result<String, WgslError> {
        let name = self.arguments.get(index as usize).cloned();
        name.ok_or_else(|| WgslError::Unsupported("an argument without a name".to_owned()))
    }

    pub(super) fn local(&self, handle: Handle<LocalVariable>) -> Result<String, WgslError> {
        let name = self.locals.get(&handle).cloned();
        name.ok_or_else(|| WgslError::Unsupported("a variable without a name".to_owned()))
    }

    /// The name of a value that has one.
    pub(super) fn known(&self, handle: Handle<Expression>) -> Result<Option<&str>, WgslError> {
        match self.values.get(&handle) {
            Some(Some(name)) => Ok(Some(name)),
            Some(None) => unsupported(
                "a continuing block that uses a value of its loop, which has a continue",
            ),
            None => Ok(None),
        }
    }

    fn line(&mut self, line: &str) {
        let depth = self.blocks.len();
        self.text.extend(std::iter::repeat_n("    ", depth));
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// Opens a block of C++.
    fn open(&mut self, head: &str) {
        self.line(head);
        self.blocks.push(Vec::new());
    }

    /// Closes it: what was named in it is not seen any more.
    fn close(&mut self, end: &str) {
        for handle in self.blocks.pop().into_iter().flatten() {
            self.values.insert(handle, None);
        }
        self.line(end);
    }

    fn block(&mut self, head: &str, statements: &[Statement], end: &str) -> Done {
        self.open(head);
        self.statements(statements)?;
        self.close(end);
        Ok(())
    }

    fn statements(&mut self, statements: &[Statement]) -> Done {
        statements.iter().try_for_each(|it| self.statement(it))
    }

    fn statement(&mut self, statement: &Statement) -> Done {
        match statement {
            Statement::Emit(range) => range.clone().try_for_each(|it| self.emit(it)),
            Statement::Block(block) => self.block("{", block, "}"),
            Statement::If {
                condition,
                accept,
                reject,
            } => self.branch(*condition, accept, reject),
            Statement::Switch { selector, cases } => self.switch(*selector, cases),
            Statement::Loop {
                body,
                continuing,
                break_if,
            } => self.repeat(body, continuing, *break_if),
            Statement::Break => {
                self.line("break;");
                Ok(())
            }
            Statement::Continue => {
                self.go_on();
                Ok(())
            }
            Statement::Return { value } => self.give(*value),
            Statement::ControlBarrier(barrier) => self.barrier(*barrier, "__syncthreads();"),
            Statement::MemoryBarrier(barrier) => self.barrier(*barrier, "__threadfence_block();"),
            Statement::Store { pointer, value } => self.store(*pointer, *value),
            Statement::Atomic {
                pointer,
                fun,
                value,
                result,
            } => self.atomic(*pointer, *fun, *value, *result),
            Statement::WorkGroupUniformLoad { pointer, result } => {
                self.line("__syncthreads();");
                let value = self.value(*pointer)?;
                self.name(*result, &value)?;
                self.line("__syncthreads();");
                Ok(())
            }
            Statement::Call {
                function,
                arguments,
                result,
            } => self.call(*function, arguments, *result),
            other => unsupported(format!("the statement {other:?}")),
        }
    }

    /// Computes what has to be computed here.
    fn emit(&mut self, handle: Handle<Expression>) -> Done {
        let uses = self.uses.count(handle);
        if uses == 0 || self.is_pointer(handle) {
            return Ok(());
        }
        let is_named = self.function.named_expressions.contains_key(&handle);
        let is_now = match self.function.expressions[handle] {
            Expression::Load { pointer } => !self.is_uniform(pointer),
            Expression::AccessIndex { .. } => false,
            _ => uses > 1,
        };
        if is_named || is_now {
            let value = self.written(handle)?;
            self.name(handle, &value)?;
        }
        Ok(())
    }

    /// Declares a value, by the name that it has in WGSL if there is one.
    fn name(&mut self, handle: Handle<Expression>, value: &str) -> Done {
        let ty = self.shader.resolved_name(&self.info[handle].ty)?;
        let number = format!("e{}", handle.index());
        let named = &self.function.named_expressions;
        let wish = named.get(&handle).map_or(number.as_str(), |name| name);
        let name = self.names.fresh(wish);
        self.line(&format!("const {ty} {name} = {value};"));
        self.values.insert(handle, Some(name));
        if let Some(block) = self.blocks.last_mut() {
            block.push(handle);
        }
        Ok(())
    }

    /// The result of something that has to be done in any case.
    fn outcome(&mut self, result: Option<Handle<Expression>>, value: &str) -> Done {
        match result {
            Some(result) if self.uses.count(result) > 0 => self.name(result, value),
            _ => {
                self.line(&format!("{value};"));
                Ok(())
            }
        }
    }

    fn branch(&mut self, condition: Handle<Expression>, accept: &Block, reject: &Block) -> Done {
        if accept.is_empty() {
            let head = format!("if (!{}) {{", self.operand(condition)?);
            return self.block(&head, reject, "}");
        }
        let head = format!("if ({}) {{", self.value(condition)?);
        if reject.is_empty() {
            return self.block(&head, accept, "}");
        }
        self.block(&head, accept, "} else {")?;
        self.blocks.push(Vec::new());
        self.statements(reject)?;
        self.close("}");
        Ok(())
    }

    fn switch(&mut self, selector: Handle<Expression>, cases: &[SwitchCase]) -> Done {
        let head = format!("switch ({}) {{", self.value(selector)?);
        self.line(&head);
        for case in cases {
            let label = match case.value {
                SwitchValue::I32(n) => format!("case {n}:"),
                SwitchValue::U32(n) => format!("case {n}u:"),
                SwitchValue::Default => "default:".to_owned(),
            };
            if case.fall_through && case.body.is_empty() {
                self.line(&label);
                continue;
            }
            self.open(&format!("{label} {{"));
            self.statements(&case.body)?;
            if !case.fall_through && !case.body.last().is_some_and(leaves) {
                self.line("break;");
            }
            self.close("}");
        }
        self.line("}");
        Ok(())
    }

    /// What is done between two rounds comes last; where the loop has a `continue`, behind a label.
    fn repeat(
        &mut self,
        body: &Block,
        continuing: &Block,
        break_if: Option<Handle<Expression>>,
    ) -> Done {
        let ends = !continuing.is_empty() || break_if.is_some();
        let label = (ends && continues(body)).then(|| self.names.fresh("next"));
        self.open("for (;;) {");
        self.loops.push(label.clone());
        match label {
            // No `goto` may leap over the names that are seen at its label.
            Some(label) => {
                self.block("{", body, "}")?;
                self.line(&format!("{label}:;"));
            }
            None => self.statements(body)?,
        }
        self.loops.pop();
        self.statements(continuing)?;
        if let Some(condition) = break_if {
            let line = format!("if ({}) break;", self.value(condition)?);
            self.line(&line);
        }
        self.close("}");
        Ok(())
    }

    fn go_on(&mut self) {
        match self.loops.last().cloned().flatten() {
            Some(label) => self.line(&format!("goto {label};")),
            None => self.line("continue;"),
        }
    }

    fn give(&mut self, value: Option<Handle<Expression>>) -> Done {
        let line = match value {
            Some(value) => format!("return {};", self.value(value)?),
            None => "return;".to_owned(),
        };
        self.line(&line);
        Ok(())
    }

    fn barrier(&mut self, barrier: Barrier, line: &str) -> Done {
        if barrier.intersects(Barrier::SUB_GROUP | Barrier::TEXTURE) {
            return unsupported(format!("the barrier {barrier:?}"));
        }
        self.line(line);
        Ok(())
    }

    fn store(&mut self, pointer: Handle<Expression>, value: Handle<Expression>) -> Done {
        let value = self.value(value)?;
        let line = match self.function.expressions[pointer] {
            Expression::Access { base, index }
                if matches!(self.pointee(base), TypeInner::Vector { .. }) =>
            {
                let (vector, index) = (self.operand(base)?, self.value(index)?);
                format!("{vector}.put({index}, {value});")
            }
            _ => match self.pointee(pointer) {
                TypeInner::Atomic(_) => {
                    format!("maths::store({}, {value});", self.value(pointer)?)
                }
                _ => format!("{} = {value};", self.value(pointer)?),
            },
        };
        self.line(&line);
        Ok(())
    }

    fn atomic(
        &mut self,
        pointer: Handle<Expression>,
        fun: AtomicFunction,
        value: Handle<Expression>,
        result: Option<Handle<Expression>>,
    ) -> Done {
        let (at, value) = (self.operand(pointer)?, self.value(value)?);
        let name = match fun {
            AtomicFunction::Add => "Add",
            AtomicFunction::Subtract => "Sub",
            AtomicFunction::And => "And",
            AtomicFunction::ExclusiveOr => "Xor",
            AtomicFunction::InclusiveOr => "Or",
            AtomicFunction::Min => "Min",
            AtomicFunction::Max => "Max",
            AtomicFunction::Exchange { compare: None } => "Exch",
            AtomicFunction::Exchange {
                compare: Some(compare),
            } => {
                let compare = self.value(compare)?;
                let Some(result) = result else {
                    return unsupported("an exchange without a result");
                };
                let ty = self.shader.resolved_name(&self.info[result].ty)?;
                let text = format!("maths::exchanged<{ty}>({at}, {compare}, {value})");
                return self.outcome(Some(result), &text);
            }
        };
        self.outcome(result, &format!("::atomic{name}(&{at}, {value})"))
    }

    fn call(
        &mut self,
        function: Handle<Function>,
        arguments: &[Handle<Expression>],
        result: Option<Handle<Expression>>,
    ) -> Done {
        let mut parts = vec!["globals".to_owned()];
        for &argument in arguments {
            parts.push(self.value(argument)?);
        }
        let name = self.shader.function_name(function)?;
        let call = format!("{name}({})", parts.join(", "));
        self.outcome(result, &call)
    }
}

/// Whether a loop's body goes on to its next round from anywhere but its end.
fn continues(block: &Block) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Continue => true,
        Statement::Block(block) => continues(block),
        Statement::If { accept, reject, .. } => continues(accept) || continues(reject),
        Statement::Switch { cases, .. } => cases.iter().any(|case| continues(&case.body)),
        _ => false,
    })
}

fn leaves(statement: &Statement) -> bool {
    matches!(
        statement,
        Statement::Break | Statement::Continue | Statement::Return { .. } | Statement::Kill
    )
}
