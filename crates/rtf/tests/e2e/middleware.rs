//! Environment variables for ports and middleware in a suite's processes.

use crate::isolation::prepared;
use crate::support::Folder;

/// Prints what a suite's processes find in their environment.
const ENVIRONMENT: &str = "sh -c 'env | grep -E \"^(ROS_|FAST|YARP_|GZ_|IGN_|GAZEBO_|RTF_PORT_)\" \
     | sort | cut -d= -f1 | tr \"\\n\" \" \"; echo; echo domain $ROS_DOMAIN_ID port $RTF_PORT_SIM ${port:sim}'";

fn environment(attributes: &str, inside: &str, domain: Option<&str>) -> (Folder, String) {
    let folder = Folder::new();
    let command = ENVIRONMENT.replace('"', "&quot;");
    let test = "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        pass\n";
    let hook = format!("<hook on='end' name='h'><command>{command}</command></hook>");
    let suite =
        format!("<suite name='s' {attributes}>{inside}{hook}<test type='python'>T</test></suite>");
    folder.file("T.py", test).file("s.xml", &suite);
    let mut command = folder.command(&["run", "s.xml"]);
    for name in [
        "ROS_DOMAIN_ID",
        "ROS_AUTOMATIC_DISCOVERY_RANGE",
        "ROS_DISTRO",
        "ROS_MASTER_URI",
        "YARP_NAMESPACE",
        "GZ_PARTITION",
        "FASTDDS_DEFAULT_PROFILES_FILE",
        "FASTRTPS_DEFAULT_PROFILES_FILE",
    ] {
        command.env_remove(name);
    }
    if let Some(domain) = domain {
        command.env("ROS_DOMAIN_ID", domain);
    }
    let output = command.output().expect("rtf runs");
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{told}");
    let log = std::fs::read_to_string(folder.path().join("rtf-results/latest/logs/s.hook-h.log"));
    let log = log.expect("the hook's log");
    (folder, format!("{told}-----\n{log}"))
}

fn domain_of(folder: &Folder) -> (String, bool) {
    let own = prepared(folder, "rtf-results").variables;
    let domain = own.into_iter().find(|own| own.name == "ROS_DOMAIN_ID").expect("a domain");
    (domain.value, domain.inherited)
}

const PROCESS: &str = "<fixture type='process' name='f'><command>sleep 1000</command></fixture>";

#[test]
fn every_process_finds_its_suites_ports_and_ids() {
    let (folder, told) = environment("", PROCESS, None);
    let own = prepared(&folder, "rtf-results");
    let sim = own.ports.iter().find(|own| own.name == "sim").expect("a port").port;
    let (domain, kept) = domain_of(&folder);
    assert!(!kept && (1..=101).contains(&domain.parse::<u32>().expect("a number")));
    assert!(told.contains(&format!("domain {domain} port {sim} {sim}\n")), "{told}");
    let names = "FASTDDS_DEFAULT_PROFILES_FILE GAZEBO_MASTER_URI GZ_PARTITION IGN_PARTITION ROS_AUTOMATIC_DISCOVERY_RANGE \
         ROS_DOMAIN_ID ROS_HOSTNAME ROS_LOG_DIR ROS_MASTER_URI RTF_PORT_GAZEBO_MASTER RTF_PORT_ROS_MASTER RTF_PORT_SIM YARP_NAMESPACE";
    assert!(told.contains(names), "{told}");
    let log = std::fs::read_to_string(folder.path().join("rtf-results/latest/logs/s.suite.log"));
    assert!(log.expect("a log").contains(&format!("join: {}\n", own.join_command)));
}

#[test]
fn a_domain_of_the_users_shell_is_kept_and_said() {
    let (folder, told) = environment("", PROCESS, Some("77"));
    assert_eq!(domain_of(&folder), ("77".to_owned(), true));
    assert!(told.contains("inherited  ROS_DOMAIN_ID=77 from your environment"), "{told}");
    assert!(told.contains("domain 77 port "), "{told}");
    assert!(!told.contains("ROS_AUTOMATIC_DISCOVERY_RANGE"), "{told}");
}

#[test]
fn who_wants_middleware_of_its_own_has_it() {
    for attributes in ["middleware='own'", "isolate='network'"] {
        let (folder, told) = environment(attributes, PROCESS, Some("102"));
        let (domain, kept) = domain_of(&folder);
        assert!(domain != "102" && !kept, "{told}");
        assert!(told.contains(&format!("domain {domain} port ")), "{told}");
    }
    let own = format!("<env name='ROS_DOMAIN_ID' value='102'/>{PROCESS}");
    let (_, told) = environment("middleware='own'", &own, None);
    assert!(told.contains("domain 102 port "), "{told}");
}

/// A test that starts nodes of ROS 2 would be heard in the whole network.
#[test]
fn a_suite_without_fixtures_has_only_a_domain_of_ros_2() {
    let (folder, told) = environment("", "", None);
    let (domain, _) = domain_of(&folder);
    let names =
        "FASTDDS_DEFAULT_PROFILES_FILE ROS_AUTOMATIC_DISCOVERY_RANGE ROS_DOMAIN_ID RTF_PORT_SIM";
    assert!(told.contains(&format!("-----\n{names} \ndomain {domain} port ")), "{told}");
    let profile = folder.path().join("rtf-results/latest/fastdds.xml");
    assert!(std::fs::read_to_string(profile).expect("a profile").contains("leaseAnnouncement"));
    // The user's domain is not reported: nothing is private.
    let (folder, told) = environment("", "", Some("77"));
    assert!(prepared(&folder, "rtf-results").variables.is_empty());
    assert!(told.contains("-----\nROS_DOMAIN_ID RTF_PORT_SIM \ndomain 77 port "), "{told}");
    assert!(!told.contains("inherited"), "{told}");
}

/// Prints the domain of each test, while both run.
const TOGETHER: &str = "import os, rtf\n\
    class T(rtf.TestCase):\n    def run(self):\n        domain = os.environ['ROS_DOMAIN_ID']\n        \
    open(self.param, 'w').write(domain)\n        \
    other = {'a': 'b', 'b': 'a'}[self.param]\n        \
    while not os.path.exists(other) or not open(other).read(): self.sleep(0.01)\n        \
    self.require(open(other).read() != domain, 'the other test has another domain')\n";

#[test]
fn parallel_tests_can_have_a_domain_each() {
    let tests = |attribute: &str| {
        let test = |name| format!("<test type='python' param='{name}' {attribute}>T</test>");
        format!("<suite name='s' parallel='2'>{}{}</suite>", test("a"), test("b"))
    };
    for (attribute, code) in [("middleware='own'", 0), ("", 1)] {
        let folder = Folder::new();
        folder.file("T.py", TOGETHER).file("s.xml", &tests(attribute));
        let mut command = folder.command(&["run", "s.xml"]);
        let output = command.env_remove("ROS_DOMAIN_ID").output().expect("rtf runs");
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(code), "{told}");
        let variables = prepared(&folder, "rtf-results").variables;
        let suites = variables.iter().find(|own| own.name == "ROS_DOMAIN_ID").expect("a domain");
        let domain = std::fs::read_to_string(folder.path().join("a")).expect("its domain");
        assert_eq!(domain == suites.value, attribute.is_empty(), "{told}");
    }
}

#[test]
fn a_suite_can_share_middleware() {
    for (attributes, inside) in [("middleware='shared'", ""), ("middleware='shared'", PROCESS)] {
        let (folder, told) = environment(attributes, inside, None);
        assert!(prepared(&folder, "rtf-results").variables.is_empty());
        assert!(told.contains("-----\nRTF_PORT_SIM \ndomain port "), "{told}");
    }
}
