# frozen_string_literal: true

require "open3"
require_relative "driver"

# Loading and checking of files.
class LoadingTest < HostTest
  BAD = {
    "X = 1" => "`FILE` has no class that derives from RTF::TestCase",
    "class Sim < RTF::FixtureManager; end" =>
      "`FILE` has no class that derives from RTF::TestCase; it has `Sim`",
    "class A < RTF::TestCase; end; class B < RTF::TestCase; end" =>
      "`FILE` has several classes that derive from RTF::TestCase: `A`, `B`",
    "class Arm < RTF::TestCase; end" => "NotImplementedError: Arm has no `run`",
    "class Arm < RTF::TestCase; def initialize = raise(\"no\"); end" => "RuntimeError: no",
    "require \"nowhere\"" => "LoadError: cannot load such file -- nowhere"
  }.freeze

  def test_a_file_that_is_no_test_is_an_error
    BAD.each do |body, reason|
      result, host, = run_plugin("require \"rtf\"\n#{body}\n")
      expected = reason.sub("FILE", File.join(@directory, "plugin.rb"))
      assert_equal({ "outcome" => "error" }, result, body)
      assert_equal ["error", expected], host.problem, body
    end
  end

  def test_a_syntax_error_is_reported_with_its_line
    _, host, = run_plugin("x = 1\ndef broken(:\n")
    assert_match(/\ASyntaxError: .*syntax error/m, host.texts.first.last)
    assert_equal 2, host.of("message").first["location"]["line"]
  end

  def test_bases_in_the_file_and_required_classes_do_not_count
    File.write(File.join(@directory, "bases.rb"),
               "require \"rtf\"\nclass Other < RTF::TestCase; end\n")
    body = "require \"bases\"\nclass Base < Other\n  def run = report(self.class)\nend\n" \
           "class Arm < Base; end\ndef helper = 1\n"
    assert_equal [%w[report Arm]], run_plugin(body)[1].texts
  end

  def test_methods_of_the_file_can_be_called
    body = "#{arm("report(connect)")}\ndef connect = \"connected\"\n"
    assert_equal [%w[report connected]], run_plugin(body)[1].texts
  end

  def test_the_second_plugin_of_a_host_is_not_the_first
    host = self.host
    %w[first second].each do |text|
      body = arm("report(#{text.inspect}); report(defined?(Left).inspect)", "  #{text} = 1\n") +
             (text == "first" ? "class Left; end\n" : "")
      params = plugin(body, name: "#{text}.rb", is_last: text == "second")
      assert_equal({ "outcome" => "passed" }, host.ask("run-test", params)["result"])
    end
    assert_equal ["first", "\"constant\"", "second", "nil"], host.texts.map(&:last)
  end

  def test_output_comes_out_before_the_answer
    assert_equal "a\nb", run_body("puts \"a\"; print \"b\"").last
  end

  def test_what_cannot_be_carried_out_is_refused
    { ["paint-test", {}] => -32_601, ["run-test", { name: "Arm" }] => -32_602,
      ["run-test", { file: "a.rb", name: "Arm", args: "x" }] => -32_602,
      ["initialize", { protocol: 2, rtf: "9.0.0" }] => -32_001 }.each do |request, code|
      host = self.host
      assert_equal code, host.ask(*request)["error"]["code"]
      # The host continues.
      assert_equal({ "outcome" => "passed" }, host.ask("tear-down-fixture", {})["result"])
    end
  end

  def test_a_line_that_is_no_request_is_refused
    host = self.host
    host.channel.write("not a message\n[]\n")
    assert_equal([-32_700, -32_600], [host.read, host.read].map { |one| one["error"]["code"] })
  end

  def test_initialize_names_the_interpreter
    expected = { "protocol" => 1, "host" => "ruby #{RUBY_VERSION}", "stack" => "message",
                 "supports_shared" => true, "selects_cases" => true }
    assert_equal expected, host.initialized["result"]
  end

  def command(*arguments)
    environment = { "RUBYLIB" => Host::LIBRARY, "RTF_CHANNEL" => nil }
    Open3.capture3(environment, *Host::COMMAND, *arguments, chdir: @directory)
  end

  CHECKED = {
    "test.rb" => ["puts 1\nclass A < RTF::TestCase; end\nclass B < A; end\n", { kinds: ["test"] }],
    "fixture.rb" => ["module M\nclass A < ::RTF::FixtureManager; end\nend\n",
                     { kinds: ["fixture"] }],
    "old.rb" => ["class TestCase\nend\n", { kinds: ["test"] }],
    "unknown.rb" => ["class A < Base; end\n", {}],
    "struct.rb" => ["class A < Struct.new(:a); end\n", {}],
    "helper.rb" => ["class Client; end\ndef connect = Client.new\n", { kinds: [] }],
    "broken.rb" => ["x = 1\nclass A <\n", { ok: false, line: 2 }],
    "gone.rb" => [nil, { ok: false, message: "No such file or directory" }]
  }.freeze

  def test_files_are_checked_without_running_them
    CHECKED.each { |name, (text, _)| File.write(File.join(@directory, name), text) if text }
    output, _, status = command("--check", *CHECKED.keys)
    assert_predicate status, :success?
    CHECKED.zip(output.lines.map { |line| JSON.parse(line) }) do |(name, (_, expected)), found|
      expected = JSON.parse(JSON.generate({ file: name, ok: true, **expected }))
      assert_equal expected, found.slice("file", "kinds", *expected.keys), name
    end
  end

  def test_a_host_that_no_runner_started_says_so
    _, errors, status = command
    assert_equal 2, status.exitstatus
    assert_includes errors, "`rtf` starts"
  end
end
