# frozen_string_literal: true

require "json"
require "minitest/autorun"
require "rbconfig"
require "socket"
require "timeout"
require "tmpdir"

# Plays the runner: starts the real host over a socket pair and keeps what it says.
class Host
  LIBRARY = File.expand_path("../lib", __dir__)
  COMMAND = [RbConfig.ruby, "-e", 'require "rtf/host"; RTF::Host.main', "--"].freeze
  # Far beyond what any of these tests takes: a host that hangs fails its test.
  LIMIT_SECONDS = 60

  attr_reader :seen, :initialized, :pid, :channel

  def initialize(folder)
    @channel, theirs = UNIXSocket.pair
    @output, output = IO.pipe
    environment = { "RUBYLIB" => LIBRARY, "RTF_CHANNEL" => "fd:#{theirs.fileno}" }
    @pid = Process.spawn(environment, *COMMAND, theirs.fileno => theirs.fileno, chdir: folder,
                                                out: output, err: output)
    [theirs, output].each(&:close)
    @seen = []
    @initialized = ask("initialize", { protocol: 1, rtf: "0.1.0" })
  end

  def send(method, params, number = nil)
    message = { jsonrpc: "2.0", id: number, method: method, params: params }.compact
    @channel.write("#{JSON.generate(message)}\n")
  end

  # Sends a request and waits for its answer.
  def ask(method, params)
    send(method, params, 1)
    answer
  end

  # The next line; nil when the host has closed the channel.
  def read
    line = Timeout.timeout(LIMIT_SECONDS) { @channel.gets }
    return unless line

    JSON.parse(line).tap { |message| @seen << message }
  rescue Errno::ECONNRESET
    nil
  end

  # The next answer.
  def answer
    while (message = read)
      return message if message.key?("id")
    end
    raise "no answer; the host wrote #{@output.read}"
  end

  # The parameters of the next notification of this kind.
  def wait_for(method)
    while (message = read)
      return message["params"] if message["method"] == method
    end
    raise "no `#{method}`; the host wrote #{@output.read}"
  end

  # The parameters of all notifications of this kind so far.
  def of(method)
    @seen.select { |message| message["method"] == method }.map { |message| message["params"] }
  end

  # Kind and text of all messages so far.
  def texts
    of("message").map { |message| message.values_at("kind", "text") }
  end

  # Kind and first line of the first failure or error so far.
  def problem
    kind, text = texts.find { |one, _| %w[failure error].include?(one) }
    [kind, text&.lines(chomp: true)&.first]
  end

  # The starts and ends of cases, and the messages with their cases.
  def case_events
    @seen.filter_map do |line|
      params = line["params"]
      case line["method"]
      when "case-started" then ["start", *params.values_at("case", "name", "parent")]
      when "case-finished" then ["end", params["case"]]
      when "message" then [params["kind"], params["text"].lines.first.chomp, params["case"]]
      end
    end
  end

  # Sends nothing more, like a runner that is gone.
  def close
    @channel.close_write
  end

  # Waits for the end of the process: its status, and what it printed.
  def finish
    nil while read
    output = Timeout.timeout(LIMIT_SECONDS) { @output.read }
    _, status = Process.wait2(@pid)
    [status, output]
  end

  # Ends the process of a failed test.
  def kill
    Process.kill(:KILL, @pid)
    Process.wait(@pid)
  rescue Errno::ESRCH, Errno::ECHILD
    nil
  end
end

# The base of all tests: a directory, hosts, and plug-ins in it.
class HostTest < Minitest::Test
  def setup
    @directory = Dir.mktmpdir
    @hosts = []
  end

  def teardown
    @hosts.each(&:kill)
    FileUtils.rm_rf(@directory)
  end

  def host
    Host.new(@directory).tap { |host| @hosts << host }
  end

  # Writes a plug-in and returns the parameters of a request about it.
  def plugin(body, name: "plugin.rb", **more)
    file = File.join(@directory, name)
    File.write(file, body)
    { file: file, name: "Arm", param: "--rate 100", args: ["--rate", "100"],
      environment: "--robot sim", repetition: 3, is_last: true, **more }
  end

  # A test with this body of `run`, and further methods.
  def arm(body, more = "")
    "require \"rtf\"\nclass Arm < RTF::TestCase\n  def run\n#{body}\n  end\n#{more}end\n"
  end

  # Runs a test to its end: its answer, the host that has ended, its status and output.
  def run_plugin(body, **more)
    host = self.host
    host.send("run-test", plugin(body, **more), 2)
    status, output = host.finish
    answer = host.seen.find { |message| message["id"] == 2 }
    [answer && answer["result"], host, status, output]
  end

  def run_body(body, more = "")
    run_plugin(arm(body, more))
  end

  def events_of(body, more = "")
    run_body(body, more)[1].case_events
  end
end
