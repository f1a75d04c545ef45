//! A PostgreSQL database: for a team.

use std::collections::HashMap;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use postgres::config::Host;
use postgres::fallible_iterator::FallibleIterator as _;
use postgres::types::ToSql;
use postgres::{Client, Config, Statement};

use super::tls::{Encryption, SslMode, connector};
use super::{DatabaseError, Row, Value, Visit, dialect};
use crate::store::schema;

/// How long a connection may take, unless the address says otherwise with `connect_timeout`: the
/// end of a run waits for it.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(1);

/// How long a server may be silent while it has unanswered data.
const SILENCE_TIMEOUT: Duration = Duration::from_secs(5);

/// For each connection: the tables, how long a writer waits for another one, and plain strings.
const SETTINGS: &str = "
SET search_path TO rtf_history;
SET lock_timeout TO '5s';
SET client_min_messages TO warning;
SET application_name TO rtf";

/// Lets one writer in at a time; the number is that of the program in SQLite.
const LOCK: &str = "BEGIN; SELECT pg_advisory_xact_lock(1381254728)";

/// The address of a PostgreSQL database. It never prints the password.
#[derive(Clone)]
pub struct PostgresUrl {
    config: Config,
    encryption: Encryption,
}

/// An address is invalid. The message does not repeat it, because it may contain a password.
#[derive(Debug, thiserror::Error)]
pub enum UrlError {
    #[error("the address of the history is not valid: `postgres://USER@HOST/DATABASE` is expected")]
    Invalid,
    #[error("unknown `sslmode`: `disable`, `prefer`, `require` or `verify-full` is expected")]
    SslMode,
}

impl PostgresUrl {
    /// Reads an address `postgres://…`.
    ///
    /// # Errors
    /// It is invalid.
    pub fn parse(url: &str) -> Result<Self, UrlError> {
        let (address, query) = url.split_once('?').unwrap_or((url, ""));
        let mut encryption = Encryption::default();
        let mut rest = Vec::new();
        for option in query.split('&').filter(|option| !option.is_empty()) {
            match option.split_once('=') {
                Some(("sslmode", mode)) => {
                    encryption.mode = SslMode::parse(mode).ok_or(UrlError::SslMode)?;
                }
                Some(("sslrootcert", file)) => encryption.root = Some(file.into()),
                _ => rest.push(option),
            }
        }
        let address = [address, &rest.join("&")].join(if rest.is_empty() { "" } else { "?" });
        let mut config: Config = address.parse().map_err(|_| UrlError::Invalid)?;
        if config.get_hosts().is_empty() || shows_options(&config) {
            return Err(UrlError::Invalid);
        }
        config.ssl_mode(encryption.ssl_mode());
        let limit = config.get_connect_timeout().copied().unwrap_or(CONNECT_TIMEOUT);
        config.connect_timeout(limit).tcp_user_timeout(SILENCE_TIMEOUT);
        Ok(Self { config, encryption })
    }
}

/// Whether options are part of a host or of the database's name, which are shown: an option may be
/// a password. That is so if a `?` is missing, or an option contains an `@`.
fn shows_options(config: &Config) -> bool {
    let is_option = |text: &str| text.contains(['?', '&', '=', '@']);
    let hosts = config.get_hosts().iter().map(|host| match host {
        Host::Tcp(host) => host.clone(),
        Host::Unix(path) => path.to_string_lossy().into_owned(),
    });
    hosts.chain(config.get_dbname().map(str::to_owned)).any(|text| is_option(&text))
}

impl std::fmt::Display for PostgresUrl {
    /// The address without user, password and options.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("postgres://")?;
        match self.config.get_hosts().first() {
            Some(Host::Tcp(host)) => f.write_str(host)?,
            Some(Host::Unix(path)) => write!(f, "{}", path.display())?,
            None => {}
        }
        if let Some(port) = self.config.get_ports().first().filter(|port| **port != 5432) {
            write!(f, ":{port}")?;
        }
        write!(f, "/{}", self.config.get_dbname().unwrap_or_default())
    }
}

impl std::fmt::Debug for PostgresUrl {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

/// An open connection.
pub(in crate::store) struct PostgresDatabase {
    client: Client,
    prepared: HashMap<String, Statement>,
}

impl std::fmt::Debug for PostgresDatabase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PostgresDatabase").finish_non_exhaustive()
    }
}

impl PostgresDatabase {
    /// Connects. The server may accept a connection and stay silent, so another thread waits.
    pub fn connect(url: &PostgresUrl) -> Result<Self, DatabaseError> {
        let connector = connector(&url.encryption)?;
        let config = url.config.clone();
        let (sender, connected) = mpsc::channel();
        let connect = move || {
            let client = config.connect(connector).and_then(|mut client| {
                client.batch_execute(SETTINGS)?;
                Ok(client)
            });
            // A connection that is late is closed.
            let _ = sender.send(client);
        };
        let started = thread::Builder::new().name("history".to_owned()).spawn(connect);
        started.map_err(|_| DatabaseError::Connection("cannot start a thread"))?;
        let limit = url.config.get_connect_timeout().copied().unwrap_or(CONNECT_TIMEOUT);
        let silent = DatabaseError::Connection(
            "the server did not answer in time (1 s, or `connect_timeout` of the address)",
        );
        let client = connected.recv_timeout(limit).map_err(|_| silent)??;
        Ok(Self { client, prepared: HashMap::new() })
    }

    pub fn for_each(
        &mut self,
        sql: &str,
        values: &[Value<'_>],
        visit: Visit<'_>,
    ) -> Result<(), DatabaseError> {
        let statement = match self.prepared.get(sql) {
            Some(statement) => statement.clone(),
            None => {
                let statement = self.client.prepare(sql)?;
                self.prepared.insert(sql.to_owned(), statement.clone());
                statement
            }
        };
        let values = values.iter().map(|value| value as &(dyn ToSql + Sync));
        let mut rows = self.client.query_raw(&statement, values)?;
        while let Some(row) = rows.next()? {
            visit(&Row::Postgres(&row))?;
        }
        Ok(())
    }

    pub fn begin(&mut self) -> Result<(), DatabaseError> {
        let begun = self.client.batch_execute(LOCK);
        if begun.is_err() {
            let _ = self.client.batch_execute("ROLLBACK");
        }
        Ok(begun?)
    }

    pub fn execute_batch(&mut self, sql: &str) -> Result<(), DatabaseError> {
        Ok(self.client.batch_execute(sql)?)
    }

    /// The number of the last migration; `None` if there are no tables.
    pub fn version(&mut self) -> Result<Option<i64>, DatabaseError> {
        let table = self.client.query_one(schema::POSTGRES_TABLE, &[])?;
        match table.try_get::<_, Option<String>>(0)? {
            None => Ok(None),
            Some(_) => Ok(self.client.query_one(schema::POSTGRES_VERSION, &[])?.try_get(0)?),
        }
    }

    /// Creates the tables, or brings them to the newest version.
    pub fn migrate(&mut self) -> Result<(), DatabaseError> {
        self.begin()?;
        let migrated = self.migrate_locked();
        self.client.batch_execute(if migrated.is_ok() { "COMMIT" } else { "ROLLBACK" })?;
        migrated
    }

    fn migrate_locked(&mut self) -> Result<(), DatabaseError> {
        self.client.batch_execute(schema::POSTGRES_SCHEMA)?;
        // Another process may have been faster.
        let version = self.version()?.unwrap_or_default();
        for (migration, number) in schema::MIGRATIONS.iter().zip(1_i64..) {
            if number > version {
                self.client.batch_execute(&dialect::postgres(migration))?;
                self.client.execute(schema::POSTGRES_MIGRATED, &[&number])?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_is_never_printed() {
        let url = "postgres://team:s3cret@db.example:5433/results?sslmode=verify-full";
        let url = PostgresUrl::parse(url).expect("an address");
        assert_eq!(url.to_string(), "postgres://db.example:5433/results");
        assert!(!format!("{url:?}").contains("s3cret"));
        for wrong in [
            "postgres://team:s3cret@:nowhere/results",
            "postgres://team:s3cret@db/x?s3cret=1",
            "postgres://team:s3cret@db/x?sslmode=s3cret",
            "postgres://",
            // With these, the driver reads the option as a part of a host or of the name.
            "postgres://db/x?application_name=a@b&password=s3cret",
            "postgres://db/x&password=s3cret",
            "postgres://db&password=s3cret",
        ] {
            let error = PostgresUrl::parse(wrong).expect_err("an error");
            assert!(!format!("{error} {error:?}").contains("s3cret"), "{error}");
        }
    }

    #[test]
    fn a_server_that_does_not_answer_is_given_up() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("a port").port();
        let url = format!("postgres://x@127.0.0.1:{port}/x?sslmode=disable");
        let error = PostgresDatabase::connect(&PostgresUrl::parse(&url).expect("an address"));
        let error = error.expect_err("silence").to_string();
        assert!(error.contains("did not answer") || error.contains("timed out"), "{error}");
    }
}
