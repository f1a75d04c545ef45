//! A PostgreSQL server in a temporary directory.

use std::fs;
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use postgres::{Client, NoTls};
use rtf_history::store::Location;

pub const PASSWORD: &str = "p%40ss";
/// The same, as it is stored.
const PLAIN_PASSWORD: &str = "p@ss";

/// PostgreSQL refuses to run as root: then this user runs it.
const USER: &str = "postgres";

/// A server that ends with this value.
pub struct Server {
    dir: tempfile::TempDir,
    port: u16,
    process: Child,
}

impl Server {
    /// Starts a server with a new data directory.
    pub fn start() -> Self {
        let dir = tempfile::tempdir().expect("a directory");
        let data = dir.path().join("data");
        fs::write(dir.path().join("password"), PLAIN_PASSWORD).expect("a file");
        let names = ["localhost".to_owned(), "127.0.0.1".to_owned()];
        let signed = rcgen::generate_simple_self_signed(names).expect("a certificate");
        fs::write(dir.path().join("server.crt"), signed.cert.pem()).expect("a file");
        fs::write(dir.path().join("server.key"), signed.signing_key.serialize_pem())
            .expect("a file");
        let key = fs::Permissions::from_mode(0o600);
        fs::set_permissions(dir.path().join("server.key"), key).expect("permissions");
        if is_root() {
            let owner = [format!("{USER}:"), dir.path().display().to_string()];
            run(Command::new("chown").arg("-R").args(owner));
        }
        let password = dir.path().join("password").display().to_string();
        run(program("initdb")
            .args(["-U", "rtf", "--auth=scram-sha-256", "--encoding=UTF8", "--locale=C.UTF-8"])
            .args(["--no-sync", "--pwfile", &password, "-D"])
            .arg(&data)
            .stdout(Stdio::null()));
        let port = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr());
        let port = port.expect("a port").port();
        let option = |name: &str, file: &str| format!("{name}={}", dir.path().join(file).display());
        let process = program("postgres")
            .args(["-h", "127.0.0.1", "-p", &port.to_string(), "-c", "ssl=on", "-c", "fsync=off"])
            .args(["-c", "log_connections=off", "-c", "log_min_messages=fatal"])
            .args(["-c", &option("ssl_cert_file", "server.crt")])
            .args(["-c", &option("ssl_key_file", "server.key")])
            .args(["-c", &format!("unix_socket_directories={}", dir.path().display()), "-D"])
            .arg(&data)
            .stderr(Stdio::null())
            .spawn();
        let server = Self { dir, port, process: process.expect("postgres starts") };
        server.wait();
        server
    }

    fn wait(&self) {
        let deadline = Instant::now() + Duration::from_secs(60);
        while self.connect("postgres").is_err() {
            assert!(Instant::now() < deadline, "the server does not accept connections");
            thread::sleep(Duration::from_millis(50));
        }
    }

    fn connect(&self, database: &str) -> Result<Client, postgres::Error> {
        Client::connect(&self.address(database, "sslmode=disable"), NoTls)
    }

    /// The address of a database.
    pub fn address(&self, database: &str, options: &str) -> String {
        // A debug build needs more than the default of 1 s for a handshake on a busy machine.
        let port = self.port;
        format!(
            "postgres://rtf:{PASSWORD}@127.0.0.1:{port}/{database}?connect_timeout=60&{options}"
        )
    }

    /// Creates a database, unless it exists.
    pub fn create(&self, name: &str) {
        let mut client = self.connect("postgres").expect("a connection");
        let known = client.query("SELECT 1 FROM pg_database WHERE datname = $1", &[&name]);
        if known.expect("an answer").is_empty() {
            client.batch_execute(&format!("CREATE DATABASE {name}")).expect("a database");
        }
    }

    /// A database, which is created if it does not exist.
    pub fn database(&self, name: &str) -> Location {
        self.create(name);
        Location::postgres(&self.address(name, "sslmode=disable")).expect("an address")
    }

    /// Executes a statement.
    pub fn execute(&self, database: &str, sql: &str) {
        self.connect(database).expect("a connection").batch_execute(sql).expect(sql);
    }

    /// Whether the only history that is connected to a database is encrypted.
    pub fn is_encrypted(&self, database: &str) -> bool {
        let sql = "SELECT ssl FROM pg_stat_ssl JOIN pg_stat_activity USING (pid)
                   WHERE datname = $1 AND application_name = 'rtf'";
        let mut client = self.connect("postgres").expect("a connection");
        client.query_one(sql, &[&database]).expect("one connection").get(0)
    }

    /// The certificate of the server.
    pub fn certificate(&self) -> PathBuf {
        self.dir.path().join("server.crt")
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // SIGINT: fast shutdown; its children end with it.
        let pid = rustix::process::Pid::from_child(&self.process);
        let ended = rustix::process::kill_process(pid, rustix::process::Signal::INT);
        ended.expect("the server gets a signal");
        self.process.wait().expect("the server ends");
    }
}

fn is_root() -> bool {
    rustix::process::getuid().is_root()
}

/// A program of the server, as a user who may run it.
fn program(name: &str) -> Command {
    let dir =
        std::env::var("RTF_POSTGRES_BIN").expect("RTF_POSTGRES_BIN: the programs of PostgreSQL");
    let mut command = Command::new("setpriv");
    if is_root() {
        command.args([format!("--reuid={USER}"), format!("--regid={USER}")]).arg("--clear-groups");
    }
    // The server does not outlive the test.
    command.args(["--pdeathsig", "INT"]).arg(Path::new(&dir).join(name)).current_dir("/");
    command
}

fn run(command: &mut Command) {
    let status = command.status().expect("a program");
    assert!(status.success(), "{command:?}: {status}");
}
