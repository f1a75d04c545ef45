//! The faults of the suite, as the runner passes them.

use std::path::PathBuf;

use rtf_host::fixture_owner;
use rtf_model::protocol::Plugin;
use rtf_model::{
    FaultAction, FaultAmount, FaultConfig, FaultKind, FaultTarget, FaultsConfig, NetworkFault,
    ValuesFault, value_text,
};

use crate::targets::Targets;

#[derive(Debug)]
pub(crate) struct FaultSettings {
    /// As the suite declares it.
    pub config: FaultConfig,
    pub effect: EffectSettings,
}

impl FaultSettings {
    pub fn kind(&self) -> FaultKind {
        self.config.action.kind()
    }
}

/// What it does.
#[derive(Debug)]
pub(crate) enum EffectSettings {
    Kill(Targets),
    Stop(Targets),
    Slow {
        targets: Targets,
        percent: u32,
    },
    Memory(FaultAmount),
    Disk {
        dir: PathBuf,
        amount: FaultAmount,
    },
    Network {
        fault: NetworkFault,
        port: Option<u16>,
        seed: u32,
    },
    /// The socket is that of the fixture, a proxy.
    Values {
        fixture: String,
        socket: String,
        fault: ValuesFault,
    },
}

/// Everything that the suite declares.
#[derive(Debug, Default)]
pub(crate) struct Settings {
    pub faults: Vec<FaultSettings>,
    pub has_clock: bool,
}

impl Settings {
    /// Reads the parameter string and the arguments of the fixture.
    pub fn read(plugin: &Plugin) -> Result<Self, String> {
        let config: FaultsConfig = serde_json::from_str(&plugin.param)
            .map_err(|error| format!("the fixture's parameters are invalid: {error}"))?;
        let mut args = plugin.args.iter();
        let mut faults = Vec::new();
        for config in config.faults {
            let targets = |target: &FaultTarget| {
                let owner = fixture_owner(&plugin.name, &target.fixture)?;
                Ok::<_, String>(Targets::new(&owner, target))
            };
            let effect = match &config.action {
                FaultAction::Kill(target) => EffectSettings::Kill(targets(target)?),
                FaultAction::Stop(target) => EffectSettings::Stop(targets(target)?),
                FaultAction::Slow { target, percent } => {
                    EffectSettings::Slow { targets: targets(target)?, percent: *percent }
                }
                FaultAction::Memory(amount) => EffectSettings::Memory(*amount),
                FaultAction::Disk(amount) => {
                    let dir = args.next().map(PathBuf::from);
                    let dir = dir.ok_or("the directory of a fault is missing")?;
                    EffectSettings::Disk { dir, amount: *amount }
                }
                FaultAction::Network(fault) => {
                    let port = if fault.has_port { Some(port(args.next())?) } else { None };
                    EffectSettings::Network { fault: *fault, port, seed: config.seed }
                }
                FaultAction::Values { fixture, fault } => EffectSettings::Values {
                    fixture: fixture.clone(),
                    socket: socket_of(plugin, fixture)?,
                    fault: fault.clone(),
                },
            };
            faults.push(FaultSettings { config, effect });
        }
        Ok(Self { faults, has_clock: config.has_clock })
    }

    /// Whether a test can inject one of the faults.
    pub fn has_requested(&self) -> bool {
        self.faults.iter().any(|fault| fault.config.at.is_none())
    }
}

/// The socket of a proxy.
fn socket_of(plugin: &Plugin, fixture: &str) -> Result<String, String> {
    let name = format!("{fixture}.fault-socket");
    let socket = plugin.fixture_values.iter().find(|value| value.name == name);
    let socket = socket.ok_or_else(|| {
        format!("the fixture `{fixture}` is no proxy: it provides no value `fault-socket`")
    })?;
    Ok(value_text(&socket.value).into_owned())
}

fn port(argument: Option<&String>) -> Result<u16, String> {
    let text = argument.map(String::as_str).unwrap_or_default();
    text.trim().parse().map_err(|_| format!("`{text}` is not a port"))
}
