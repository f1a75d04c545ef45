//! Values of statements and of rows.

use bytes::BytesMut;
use postgres::types::{IsNull, ToSql, Type};

use super::DatabaseError;

/// A value of a statement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Value<'a> {
    Null,
    Int(i64),
    Real(f64),
    Text(&'a str),
    Blob(&'a [u8]),
}

macro_rules! from {
    ($($variant:ident: $type:ty => $convert:expr;)*) => {$(
        impl<'a> From<$type> for Value<'a> {
            fn from(value: $type) -> Self {
                Self::$variant($convert(value))
            }
        }
    )*};
}

from! {
    Int: i64 => std::convert::identity;
    Int: u32 => i64::from;
    Int: bool => i64::from;
    // More than 2^63 of anything is as good as 2^63.
    Int: u64 => |number| i64::try_from(number).unwrap_or(i64::MAX);
    Real: f64 => std::convert::identity;
    Text: &'a str => std::convert::identity;
    Text: &'a String => String::as_str;
    Blob: &'a [u8] => std::convert::identity;
}

impl<'a, T: Into<Value<'a>>> From<Option<T>> for Value<'a> {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Null, Into::into)
    }
}

impl rusqlite::ToSql for Value<'_> {
    fn to_sql(&self) -> rusqlite::Result<rusqlite::types::ToSqlOutput<'_>> {
        use rusqlite::types::{ToSqlOutput, ValueRef};
        Ok(ToSqlOutput::Borrowed(match *self {
            Self::Null => ValueRef::Null,
            Self::Int(number) => ValueRef::Integer(number),
            Self::Real(number) => ValueRef::Real(number),
            Self::Text(text) => ValueRef::Text(text.as_bytes()),
            Self::Blob(bytes) => ValueRef::Blob(bytes),
        }))
    }
}

impl ToSql for Value<'_> {
    fn to_sql(
        &self,
        ty: &Type,
        out: &mut BytesMut,
    ) -> Result<IsNull, Box<dyn std::error::Error + Sync + Send>> {
        match self {
            Self::Null => Ok(IsNull::Yes),
            Self::Int(number) => number.to_sql_checked(ty, out),
            Self::Real(number) => number.to_sql_checked(ty, out),
            // PostgreSQL stores no NUL in a text.
            Self::Text(text) if text.contains('\0') => {
                text.replace('\0', "\u{fffd}").to_sql_checked(ty, out)
            }
            Self::Text(text) => text.to_sql_checked(ty, out),
            Self::Blob(bytes) => bytes.to_sql_checked(ty, out),
        }
    }

    /// Each value checks the type itself.
    fn accepts(_: &Type) -> bool {
        true
    }

    postgres::types::to_sql_checked!();
}

/// A row of an answer.
pub(crate) enum Row<'a> {
    Sqlite(&'a rusqlite::Row<'a>),
    Postgres(&'a postgres::Row),
}

impl Row<'_> {
    pub fn get<T: Column>(&self, index: usize) -> Result<T, DatabaseError> {
        T::read(self, index)
    }

    pub fn bytes(&self, index: usize) -> Result<&[u8], DatabaseError> {
        Ok(match self {
            Self::Sqlite(row) => row.get_ref(index)?.as_blob().map_err(rusqlite::Error::from)?,
            Self::Postgres(row) => row.try_get(index)?,
        })
    }

    /// The bytes of a column that may be null.
    pub fn optional_bytes(&self, index: usize) -> Result<Option<&[u8]>, DatabaseError> {
        Ok(match self {
            Self::Sqlite(row) => {
                row.get_ref(index)?.as_blob_or_null().map_err(rusqlite::Error::from)?
            }
            Self::Postgres(row) => row.try_get(index)?,
        })
    }
}

/// A type of values of rows.
pub(crate) trait Column: Sized {
    fn read(row: &Row<'_>, index: usize) -> Result<Self, DatabaseError>;
}

macro_rules! native {
    ($($type:ty),*) => {$(
        impl Column for $type {
            fn read(row: &Row<'_>, index: usize) -> Result<Self, DatabaseError> {
                Ok(match row {
                    Row::Sqlite(row) => row.get(index)?,
                    Row::Postgres(row) => row.try_get(index)?,
                })
            }
        }
    )*};
}

native!(i64, f64, String, Option<i64>, Option<f64>, Option<String>);

impl Column for bool {
    fn read(row: &Row<'_>, index: usize) -> Result<Self, DatabaseError> {
        Ok(row.get::<i64>(index)? != 0)
    }
}

impl Column for Option<bool> {
    fn read(row: &Row<'_>, index: usize) -> Result<Self, DatabaseError> {
        Ok(row.get::<Option<i64>>(index)?.map(|number| number != 0))
    }
}

macro_rules! unsigned {
    ($($type:ty),*) => {$(
        impl Column for $type {
            fn read(row: &Row<'_>, index: usize) -> Result<Self, DatabaseError> {
                Ok(row.get::<i64>(index)?.try_into()?)
            }
        }

        impl Column for Option<$type> {
            fn read(row: &Row<'_>, index: usize) -> Result<Self, DatabaseError> {
                Ok(row.get::<Option<i64>>(index)?.map(TryInto::try_into).transpose()?)
            }
        }
    )*};
}

unsigned!(u32, u64);
