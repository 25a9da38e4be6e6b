//! Forms: fields, and values that are checked against them.

use crate::error::{SessionError, within};
use crate::protocol::{Field, FieldKind, Values};

impl Field {
    /// A number.
    pub fn number(name: &str, label: &str, unit: &str, value: f64, [min, max]: [f64; 2]) -> Self {
        let kind = FieldKind::Number {
            min,
            max,
            logarithmic: false,
        };
        Self::new(name, label, unit, value, kind)
    }
    /// A number whose size matters more than its distance from others.
    pub fn logarithmic(name: &str, label: &str, unit: &str, value: f64, range: [f64; 2]) -> Self {
        let [min, max] = range;
        let kind = FieldKind::Number {
            min,
            max,
            logarithmic: true,
        };
        Self::new(name, label, unit, value, kind)
    }
    /// A whole number.
    pub fn integer(name: &str, label: &str, value: usize, [min, max]: [usize; 2]) -> Self {
        let (min, max) = (min as f64, max as f64);
        Self::new(
            name,
            label,
            "",
            value as f64,
            FieldKind::Integer { min, max },
        )
    }
    /// Yes or no.
    pub fn flag(name: &str, label: &str, value: bool) -> Self {
        Self::new(name, label, "", f64::from(value), FieldKind::Flag)
    }
    /// One of several.
    pub fn choice(name: &str, label: &str, value: usize, names: &[&str]) -> Self {
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        Self::new(name, label, "", value as f64, FieldKind::Choice { names })
    }
    /// The same, with a sentence that tells what it does.
    pub fn help(mut self, help: &str) -> Self {
        self.help = help.into();
        self
    }

    /// The same, with what is to be known of it now.
    pub fn note(mut self, note: &str) -> Self {
        self.note = Some(note.into());
        self
    }

    fn new(name: &str, label: &str, unit: &str, value: f64, kind: FieldKind) -> Self {
        Self {
            name: name.into(),
            label: label.into(),
            unit: unit.into(),
            help: String::new(),
            note: None,
            kind,
            value,
        }
    }

    /// Refuses a value that it does not take.
    fn check(&self, value: f64) -> Result<(), SessionError> {
        let [min, max, whole] = match &self.kind {
            FieldKind::Number { min, max, .. } => [*min, *max, 0.0],
            FieldKind::Integer { min, max } => [*min, *max, 1.0],
            FieldKind::Flag => [0.0, 1.0, 1.0],
            FieldKind::Choice { names } => [0.0, names.len() as f64 - 1.0, 1.0],
        };
        within(&self.name, value, min, max)?;
        if whole == 1.0 && value.fract() != 0.0 {
            return Err(SessionError::Value {
                name: self.name.clone(),
                value,
                range: format!("a whole number from {min} to {max}"),
            });
        }
        Ok(())
    }
}

/// Fields whose values are ones that they take.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    fields: Vec<Field>,
}

impl Form {
    /// Fields as they are.
    pub fn new(fields: Vec<Field>) -> Self {
        Self { fields }
    }
    /// The same with other values; those not given stay.
    ///
    /// # Errors
    /// A name or a value that no field takes.
    pub fn with(mut self, values: &Values) -> Result<Self, SessionError> {
        for (name, &value) in values {
            let known = self.names();
            let field = self.fields.iter_mut().find(|field| field.name == *name);
            let field = field.ok_or_else(|| SessionError::Field {
                name: name.clone(),
                known,
            })?;
            field.check(value)?;
            field.value = value;
        }
        Ok(self)
    }
    fn names(&self) -> String {
        let names: Vec<_> = self.fields.iter().map(|f| f.name.as_str()).collect();
        if names.is_empty() {
            "none".into()
        } else {
            names.join(", ")
        }
    }
    /// Its fields.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }
    /// A field's value.
    ///
    /// Panics where there is no such field: names are the program's own.
    pub fn number(&self, name: &str) -> f64 {
        let field = self.fields.iter().find(|field| field.name == name);
        field.unwrap_or_else(|| panic!("a field `{name}`")).value
    }
    /// As [`number`](Self::number), of a field of whole numbers or choices.
    pub fn integer(&self, name: &str) -> usize {
        self.number(name) as usize
    }
    /// As [`number`](Self::number), of a flag.
    pub fn flag(&self, name: &str) -> bool {
        self.number(name) != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form() -> Form {
        Form::new(vec![
            Field::integer("links", "Links", 3, [1, 30]),
            Field::number("length", "Length", "m", 3.0, [0.1, 10.0]),
            Field::choice("start", "Start", 1, &["hanging", "upright"]),
        ])
    }

    #[test]
    fn values_are_taken_by_name_and_the_others_stay() {
        let values = Values::from([("links".into(), 5.0)]);
        let form = form().with(&values).unwrap();
        assert_eq!((form.integer("links"), form.number("length")), (5, 3.0));
    }

    #[test]
    fn what_no_field_takes_is_refused_with_what_it_takes() {
        let refused = |name: &str, value: f64| {
            let values = Values::from([(name.to_owned(), value)]);
            form().with(&values).unwrap_err().to_string()
        };
        assert!(refused("link", 3.0).contains("known are links, length, start"));
        assert!(refused("links", 31.0).contains("from 1 to 30"));
        assert!(refused("links", 2.5).contains("a whole number"));
        assert!(refused("length", f64::NAN).contains("from 0.1 to 10"));
        assert!(refused("start", 2.0).contains("from 0 to 1"));
    }
}
