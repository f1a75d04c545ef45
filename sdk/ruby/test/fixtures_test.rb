# frozen_string_literal: true

require_relative "driver"

# Fixtures: set-up, checks, collapses, tear-down.
class FixturesTest < HostTest
  def fixture(body)
    "require \"rtf\"\nclass Sim < RTF::FixtureManager\n#{body}\nend\n"
  end

  def set_up(body)
    host = self.host
    [host, host.ask("set-up-fixture", plugin(fixture(body)))["result"]]
  end

  def test_a_fixture_lives_through_many_requests
    host, result = set_up("def setup(args) = (@args = args; true)\n" \
                          "def check = (report(@args.first); @n = @n.to_i + 1; @n < 3)\n" \
                          "def tear_down = report(\"down\")")
    assert_equal({ "outcome" => "passed" }, result)
    checks = Array.new(3) { host.ask("check-fixture", {})["result"] }
    assert_equal({ "outcome" => "passed" }, checks[1])
    assert_equal({ "outcome" => "failed", "reason" => "check returned false" }, checks[2])
    assert_equal({ "outcome" => "passed" }, host.ask("tear-down-fixture", {})["result"])
    assert_equal ([["report", "--rate"]] * 3) + [%w[report down]], host.texts
  end

  def test_a_thread_reports_a_collapse
    host, = set_up("def setup(_) = Thread.new { collapsed(:fell) }")
    assert_equal({ "reason" => "fell" }, host.of("collapsed").first || host.wait_for("collapsed"))
    assert_equal "passed", host.ask("tear-down-fixture", {})["result"]["outcome"]
  end

  def test_a_fixture_that_cannot_be_set_up_is_torn_down
    { "false" => nil, 'raise "no sim"' => "RuntimeError: no sim",
      'error("no sim")' => "no sim", 'require(false, "up")' => "up" }.each do |line, problem|
      host, result = set_up("def setup(_) = #{line}\ndef tear_down = report(\"down\")")
      refute_equal "passed", result["outcome"], line
      assert_equal [problem ? nil : "setup returned false"], [result["reason"]], line
      assert_equal [problem], [host.problem.last], line
      host.ask("tear-down-fixture", {})
      assert_equal %w[report down], host.texts.last, line
    end
  end

  RECORDER = <<~'RUBY'
    def test_started(test) = test.name != "refused"
    def test_finished(test, verdict, reason)
      report("#{test.id} #{test.name} #{test.repetition}.#{test.attempt} #{verdict}: #{reason}")
      measure("size", 3.5, "MB")
      attach(__FILE__, name: "run.txt")
    end
  RUBY

  def test_a_fixture_is_notified_of_each_test
    host, result = set_up(RECORDER)
    assert_equal %w[test-started test-finished], result["subscriptions"]
    test = { "id" => 3, "name" => "Move", "repetition" => 2, "attempt" => 1 }
    assert_equal({ "outcome" => "passed" }, host.ask("test-started", { test: test })["result"])
    ends = { test: test, verdict: "failed", reason: "far",
             attachments_dir: File.join(@directory, "k") }
    assert_equal({ "outcome" => "passed" }, host.ask("test-finished", ends)["result"])
    assert_equal [["report", "3 Move 2.1 failed: far"]], host.texts
    assert_equal 3.5, host.of("measured").first["value"]
    assert_equal "#{@directory}/k/1-run.txt", host.of("attached").first["path"]
    refused = host.ask("test-started", { test: test.merge("name" => "refused") })["result"]
    assert_equal "test_started returned false", refused["reason"]
  end

  def test_a_fixture_without_notification_methods_does_not_subscribe
    assert_nil set_up("def check = true").last["subscriptions"]
  end

  def test_a_missing_fixture_cannot_be_checked
    host = self.host
    assert_equal "no fixture is set up", host.ask("check-fixture", {})["result"]["reason"]
    assert_equal "passed", host.ask("tear-down-fixture", {})["result"]["outcome"]
  end

  def test_one_fixture_at_a_time
    host, = set_up("")
    again = host.ask("set-up-fixture", plugin(fixture("")))["result"]
    assert_equal "a fixture is still set up in this host", again["reason"]
  end

  def test_the_host_of_a_fixture_ends_with_its_runner
    host, = set_up("def tear_down = report(\"down\")")
    host.channel.shutdown(Socket::SHUT_WR)
    assert_equal 1, host.finish.first.exitstatus
    assert_empty host.texts
  end
end
