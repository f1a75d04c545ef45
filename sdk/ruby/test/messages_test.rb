# frozen_string_literal: true

require_relative "driver"
require "rtf"

# Messages, measurements, samples and attachments.
class MessagesTest < HostTest
  def test_file_and_line_go_with_every_message
    _, host, = run_body("report(1)\ncheck(true, \"a\")\ncheck_near(1, 1, 0, \"b\")\nhelper\n" \
                        "measure(\"c\", 1)\n[1].each { require(true, \"d\") }",
                        "  def helper = wait_until(0, \"e\") { report(2) || true }\n")
    places = (host.of("message") + host.of("measured")).map { |one| one["location"] }
    assert_equal([4, 5, 6, 11, 9, 8], places.map { |place| place["line"] })
    assert_equal(["plugin.rb"], places.map { |place| File.basename(place["file"]) }.uniq)
  end

  def test_near_takes_numbers_vectors_matrices_and_angles
    lines = <<~RUBY
      check_near(1.25, 1.0, 0.1, "gain")
      check_near([1, 2, 3.5], [1, 2, 3], 0.1, "pose")
      check_near([[1, 2], [3, 4]], [1, 2, 3, 4], 0, "matrix")
      check_near([1], [1, 2], 0.1, "length")
      check_near([0, Float::NAN], [0, 0], 0.1, "sensor")
      check_near(1r/3, 0.333, 0.001, "rational")
      check_near((1..3), [1, 2, 3], 0, "range")
      check_near([], [], 0, "nothing")
      check_angle_near(3.1, -3.1, 0.1, "heading")
      check_angle_near(0, 1, 0.1, "yaw")
    RUBY
    _, host, = run_body(lines)
    assert_equal [
      ["failure", "gain: got 1.25, expected 1 ± 0.1 (off by 0.25)"],
      ["failure", "pose: got 3.5, expected 3 ± 0.1 (off by 0.5) at index 2"],
      %w[check matrix],
      ["failure", "length: got 1 values, expected 2"],
      ["failure", "sensor: got nan, expected 0 ± 0.1 at index 1"],
      %w[check rational], %w[check range], %w[check nothing], %w[check heading],
      ["failure", "yaw: got 0, expected 1 ± 0.1 (off by 1)"]
    ], host.texts
    numbers = host.of("message").map { |message| message["comparison"] }
    assert_equal({ "got" => [1.0, 2.0, 3.5], "expected" => [1.0, 2.0, 3.0], "tolerance" => 0.1,
                   "worst" => 2 }, numbers[1])
    assert_equal [0.0, nil], numbers[4]["got"]
  end

  def test_invalid_numbers_are_errors
    ['check_near("a", 1, 1, "x")', "check_near(nil, 1, 1, \"x\")", "check_near(1, 1, -1, \"x\")",
     'measure("x", "fast")', "measure(\"x\", 1, low: Float::NAN)"].each do |line|
      result, = run_body(line)
      assert_equal "error", result["outcome"], line
    end
  end

  def test_measurements_have_units_and_limits
    body = "report(measure(\"a\", 0.02, \"rad\", high: 0.05)); measure(\"b\", Float::INFINITY)"
    result, host, = run_body(body)
    first, second = host.of("measured")
    assert_equal({ "name" => "a", "value" => 0.02, "unit" => "rad", "high" => 0.05 },
                 first.except("location"))
    assert_nil second.fetch("value")
    assert_equal({ "outcome" => "failed" }, result)
    assert_equal [%w[report true]], host.texts
  end

  def test_a_file_is_copied_before_it_may_go
    keep = File.join(@directory, "keep", "deep")
    body = "2.times { File.write(\"t.csv\", \"1\"); attach(\"t.csv\", media_type: \"text/csv\"); " \
           "File.delete(\"t.csv\") }\nattach(\"gone\")"
    _, host, = run_plugin(arm(body), attachments_dir: keep)
    attached = host.of("attached")
    assert_equal(%w[1-t.csv 2-t.csv], attached.map { |one| File.basename(one["path"]) })
    assert_equal "1", File.read(attached.last["path"])
    assert_equal ["t.csv", "text/csv"], attached.first.values_at("name", "media_type")
    assert_match(/\AErrno::ENOENT: .*gone/, host.problem.last)
  end

  def test_an_attachment_without_an_extension_gets_that_of_its_file
    File.write(File.join(@directory, "plot.png"), "x")
    body = 'attach("plot.png", name: "arm 3"); attach("plot.png", name: "run.txt")'
    _, host, = run_plugin(arm(body), attachments_dir: File.join(@directory, "kept"))
    attached = host.of("attached")
    assert_equal(%w[1-arm_3.png 1-run.txt], attached.map { |one| File.basename(one["path"]) })
    assert_equal "arm 3", attached.first["name"]
  end

  def test_texts_are_those_of_all_sdks
    file = File.expand_path("../../../conformance/texts.json", __dir__)
    vectors = JSON.parse(File.read(file, encoding: "UTF-8"))
    vectors["numbers"].each { |value, text| assert_equal text, RTF::Text.number(number(value)) }
    vectors["comparisons"].each do |one|
      got, expected = one.values_at("got", "expected").map { |value| number(value) }
      comparison = RTF::Comparison.new(got, expected, one["tolerance"], angle: one["angle"])
      problem = one["problem"]
      problem ? assert_equal(problem, comparison.problem) : assert_nil(comparison.problem)
    end
  end

  # A number of the vectors, or several: those that JSON does not have are strings.
  def number(value)
    special = { "nan" => Float::NAN, "inf" => Float::INFINITY, "-inf" => -Float::INFINITY }
    value.is_a?(Array) ? value.map { |one| number(one) } : Float(special.fetch(value, value))
  end

  def test_only_files_can_be_attached
    File.mkfifo(File.join(@directory, "pipe"))
    { "pipe" => "a FIFO", "." => "a directory",
      "/dev/null" => "a device or a socket" }.each do |path, kind|
      _, host, = run_body("attach(\"#{path}\")")
      assert_match(/cannot be attached: it is #{kind}, not a file\z/, host.problem.last)
    end
  end

  def test_texts_are_never_cut_and_always_utf8
    body = 'report("x" * 20_000_000); report("a\xFFb")
            report("\xE9".dup.force_encoding("ISO-8859-1"))'
    result, host, = run_body(body)
    assert_equal({ "outcome" => "passed" }, result)
    texts = host.texts.map(&:last)
    assert_equal ["a\uFFFDb", "é"], texts.last(2)
    assert_equal 20_000_000, texts[...-2].sum(&:length)
  end

  def test_messages_of_many_threads_do_not_mix
    body = "(1..8).map { |n| Thread.new { 100.times { report(n.to_s * 500) } } }.each(&:join)"
    _, host, = run_body(body)
    assert_equal 800, host.texts.length
    assert(host.texts.all? { |_, text| text.length == 500 && text.squeeze.length == 1 })
  end

  def test_a_plugin_knows_its_name_and_parameters
    body = "report([name, param, environment, repetition].inspect); report(@args.inspect)"
    _, host, = run_body(body, "  def setup(args) = @args = args\n")
    assert_equal ['["Arm", "--rate 100", "--robot sim", 3]', '["--rate", "100"]'],
                 host.texts.map(&:last)
  end

  def test_ruby_keeps_its_own_require_and_sleep
    body = "require \"set\"; report(Set.new([1]).size); Kernel.sleep(0)"
    result, = run_body(body)
    assert_equal({ "outcome" => "passed" }, result)
  end
end
