# frozen_string_literal: true

require "json"
require "ripper"

module RTF
  module Host
    # Checks whether files can be loaded, without running them.
    module Check
      KINDS = { "TestCase" => "test", "FixtureManager" => "fixture" }.freeze
      CLASS_NAME = "TestCase"

      module_function

      # Checks each file and prints one JSON object per line.
      def files(names)
        $stdout.sync = true
        names.each { |name| puts JSON.generate(file(name)) }
      end

      # Compiles one file and returns the result.
      def file(name)
        source = File.read(name, encoding: Encoding::UTF_8)
        RubyVM::InstructionSequence.compile(source, name, name)
        kinds = kinds(Ripper.sexp(source))
        { file: name, ok: true, kinds: kinds }.compact
      rescue SyntaxError => problem
        syntax_error(name, problem.message)
      rescue SystemCallError, ArgumentError, EncodingError => problem
        { file: name, ok: false, message: problem.message.sub(/ @ .*\z/m, "") }
      end

      # `FILE:7: syntax error, unexpected …`, with the code in the lines below it.
      def syntax_error(name, text)
        first, rest = text.split("\n", 2)
        line = first[/:(\d+): /, 1]
        message = first.sub(/\A.*?:\d+: /, "").delete_suffix(" (SyntaxError)")
        message = [message, rest].compact.join("\n").rstrip
        { file: name, ok: false, message: message, line: line&.to_i }.compact
      end

      # Detects tests and fixtures by the names of base classes (the predecessor's by their
      # own). Nil (unknown) for a file whose class derives from a class of another file. A
      # file in which no class has a base class is no plug-in.
      def kinds(tree)
        kind_of = KINDS.dup
        found = []
        derived = false
        each_class(tree) do |own, above|
          derived ||= !above.nil?
          kind = kind_of[above] || (own == CLASS_NAME && above.nil? ? "test" : nil)
          next unless kind

          kind_of[own] = kind
          found << kind
        end
        found.uniq.sort.reverse if found.any? || !derived
      end

      # Yields name and base of each class; the base is nil if there is none.
      def each_class(node, &block)
        return unless node.is_a?(Array)

        if node.first == :class
          above = node[2] && (last_name(node[2]) || "?")
          yield last_name(node[1]), above
        end
        node.each { |part| each_class(part, &block) }
      end

      # The last of the names in `RTF::TestCase`.
      def last_name(node)
        return unless node.is_a?(Array)
        return node[1] if node.first == :@const

        node.reverse_each do |part|
          name = last_name(part)
          return name if name
        end
        nil
      end
    end
  end
end
