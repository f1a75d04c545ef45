# frozen_string_literal: true

module RTF
  # The parameters of a plug-in.
  class Task
    # Selects cases by their path: names joined with `/`.
    Selector = Struct.new(:equals, :contains) do
      def select?(path)
        return path.include?(contains) if contains

        inside?(path, equals) || inside?(equals, path)
      end

      # Whether a case is another one, or in it.
      def inside?(path, outer)
        path == outer || path.start_with?("#{outer}/")
      end
    end

    attr_reader :file, :name, :param, :environment, :args, :repetition, :end_marker, :variables,
                :parameters, :fixture_values

    # The directory for copies of attached files.
    attr_accessor :attachments_dir

    # Reads the parameters of `run-test` or `set-up-fixture`.
    def initialize(params)
      @file = text(params, "file")
      @name = text(params, "name")
      @param = text(params, "param", "")
      @environment = text(params, "environment", "")
      @attachments_dir = text(params, "attachments_dir", "")
      @args = params.fetch("args", [])
      @repetition = params.fetch("repetition", 0)
      @last = params["is_last"] == true
      @end_marker = text(params, "end_marker", "")
      @continues_after_failure = params["continues_after_failure"] == true
      strings = @args.is_a?(Array) && @args.all?(String)
      raise TypeError, "`args` is not a list of texts" unless strings
      raise TypeError, "`repetition` is not a whole number" unless @repetition.is_a?(Integer)

      read_values(params)
      read_cases(params)
    end

    def last?
      @last
    end

    # Whether a shared host continues after a test with this outcome.
    def continues_after?(outcome)
      outcome == "passed" || (@continues_after_failure && %w[failed skipped].include?(outcome))
    end

    # Whether the case with this path runs.
    def select?(path)
      @selectors.empty? || @selectors.any? { |selector| selector.select?(path) }
    end

    private

    # Reads the variables of a shared host, and the values of a matrix and of fixtures.
    def read_values(params)
      @variables, @parameters = %w[variables parameters].map do |name|
        objects(params, name).to_h { |one| [text(one, "name"), text(one, "value")] }
      end
      @fixture_values = objects(params, "fixture_values").to_h do |one|
        raise TypeError, "`value` is missing or null" if one["value"].nil?

        [text(one, "name"), one["value"]]
      end
    end

    # Reads which cases run.
    def read_cases(params)
      @selectors = objects(params, "cases").map do |one|
        next Selector.new(text(one, "equals")) if one.key?("equals")

        Selector.new(nil, text(one, "contains"))
      end
    end

    def objects(params, name)
      value = params.fetch(name, [])
      return value if value.is_a?(Array) && value.all?(Hash)

      raise TypeError, "`#{name}` is not a list of objects"
    end

    def text(params, name, default = nil)
      value = params.fetch(name, default)
      raise TypeError, "`#{name}` is missing or not a text" unless value.is_a?(String)

      value
    end
  end
end
