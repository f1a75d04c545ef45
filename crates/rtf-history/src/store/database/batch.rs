//! Statements with many rows of values. A database on another machine answers each statement
//! with a delay.

use std::fmt::Write as _;

use super::Value;

/// Numbers of rows of statements, the largest first. There are few, so that prepared statements
/// are used again.
const SIZES: [usize; 4] = [64, 16, 4, 1];

/// A statement that ends with rows of values, except for a tail.
#[derive(Clone, Copy, Debug)]
pub struct Batch {
    /// The statement up to its values.
    pub head: &'static str,
    /// Number of values of a row.
    pub columns: usize,
    /// What follows the values.
    pub tail: &'static str,
}

impl Batch {
    /// The statements for these values, each with its own.
    pub fn statements<'v, 'a>(
        &self,
        mut values: &'v [Value<'a>],
    ) -> impl Iterator<Item = (String, &'v [Value<'a>])> {
        std::iter::from_fn(move || {
            let left = values.len() / self.columns;
            let rows = SIZES.into_iter().find(|size| *size <= left)?;
            let (part, rest) = values.split_at(rows * self.columns);
            values = rest;
            Some((self.sql(rows), part))
        })
    }

    pub fn sql(&self, rows: usize) -> String {
        let mut sql = self.head.to_owned();
        for row in 0..rows {
            sql += if row == 0 { " (" } else { ", (" };
            for column in 1..=self.columns {
                let separator = if column == 1 { "$" } else { ", $" };
                // Writing to a string cannot fail.
                let _ = write!(sql, "{separator}{}", row * self.columns + column);
            }
            sql.push(')');
        }
        sql + self.tail
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_is_in_one_statement() {
        let batch = Batch { head: "INSERT INTO t VALUES", columns: 2, tail: " RETURNING id" };
        let values: Vec<_> = (0..2 * 86).map(Value::Int).collect();
        let statements: Vec<_> = batch.statements(&values).collect();
        let rows: Vec<_> = statements.iter().map(|(_, values)| values.len() / 2).collect();
        assert_eq!(rows, [64, 16, 4, 1, 1]);
        let joined: Vec<_> = statements.iter().flat_map(|(_, values)| values.to_vec()).collect();
        assert_eq!(joined, values);
        assert_eq!(statements[3].0, "INSERT INTO t VALUES ($1, $2) RETURNING id");
        assert!(statements[2].0.contains("($1, $2), ($3, $4), ($5, $6), ($7, $8)"));
    }
}
