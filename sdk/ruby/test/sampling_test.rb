# frozen_string_literal: true

require_relative "driver"

# Samples of signals.
class SamplingTest < HostTest
  def test_samples_come_in_batches_and_before_later_messages
    body = <<~'RUBY'
      600.times { |n| sample("speed", n, "m/s", low: 0, time: n / 100r) }
      report("r")
      sample("speed", -1, "m/s", low: 0, time: 7)
      sample("speed", Float::NAN, time: 8)
    RUBY
    result, host, = run_body(body)
    assert_equal ["failed"], result.values
    batches = host.of("sampled")
    assert_operator(batches.map { |batch| batch["points"].length }.max, :<=, 256)
    first = (0...600).map { |n| [n / 100.0, n.to_f] }
    assert_equal([*first, [7.0, -1.0], [8.0, nil]], batches.flat_map { |batch| batch["points"] })
    assert_equal(4, batches[0]["location"]["line"])
    assert_equal(%w[name unit low location points], batches[0].keys)
  end

  def test_sampling_at_a_rate_keeps_its_deadlines
    body = <<~'RUBY'
      start = Process.clock_gettime(Process::CLOCK_MONOTONIC)
      since = -> { Process.clock_gettime(Process::CLOCK_MONOTONIC) - start }
      due = []
      sample_for("speed", 0.2, 100, high: 1000) do
        due << (since.call * 100)
        Kernel.sleep(0.035) if due.length == 3
        due.length
      end
      check(since.call >= 0.2, "took its time")
      check(due.each_with_index.all? { |at, tick| at >= tick }, "none is early: #{due}")
      check(due[3] >= 5 && due.length <= 18, "what was missed is left out: #{due}")
    RUBY
    result, host, = run_body(body)
    assert_equal({ "outcome" => "passed" }, result, host.texts.inspect)
  end

  def test_a_forked_child_sends_only_its_own_samples
    _, host, = run_body('sample("speed", 1); fork { report("child"); exit!(0) }; Process.wait
                         sample("speed", 3)')
    values = host.of("sampled").flat_map { |batch| batch["points"].map(&:last) }
    assert_equal [1.0, 3.0], values
  end

  def test_a_forked_child_that_returns_sends_its_samples
    _, host, = run_body('sample("speed", 1); fork ? Process.wait : sample("speed", 2)')
    values = host.of("sampled").flat_map { |batch| batch["points"].map(&:last) }
    assert_equal [1.0, 2.0], values.sort
  end
end
