# frozen_string_literal: true

require "rtf/text"

module RTF
  # Actual and expected numbers.
  class Comparison
    # Above this many numbers only the text is sent: a line of the protocol has a limit.
    MAX_NUMBERS = 100_000
    TURN = 2 * Math::PI

    # Accepts numbers, (nested) arrays of numbers, or anything with `to_a`.
    def initialize(got, expected, tolerance, angle: false)
      @scalar = got.is_a?(Numeric) && expected.is_a?(Numeric)
      @got = numbers(got)
      @expected = numbers(expected)
      @tolerance = Float(tolerance)
      @angle = angle
      return if @tolerance.finite? && !@tolerance.negative?

      raise ArgumentError, "the tolerance #{tolerance} is not a finite number from 0"
    end

    # Describes the problem; nil if both are near.
    def problem
      return "got #{@got.length} values, expected #{@expected.length}" unless same_length?

      index = worst
      return if index.nil? || difference(index) <= @tolerance

      text = "got #{Text.number(@got[index])}, expected #{Text.number(@expected[index])} " \
             "± #{Text.number(@tolerance)}"
      off = difference(index)
      text += " (off by #{Text.number(off)})" if off.finite?
      @scalar ? text : "#{text} at index #{index}"
    end

    # The protocol's `comparison`, unless it is too long for a message.
    def to_h
      return if @got.length + @expected.length > MAX_NUMBERS

      fields = { expected: @expected, got: @got, tolerance: @tolerance }
      fields[:worst] = worst if !@scalar && same_length? && !@got.empty?
      fields
    end

    private

    def same_length?
      @got.length == @expected.length
    end

    # The index with the largest difference; non-finite numbers come first.
    def worst
      @got.each_index.find { |index| !difference(index).finite? } ||
        @got.each_index.max_by { |index| [difference(index), -index] }
    end

    def difference(index)
      got = @got[index]
      expected = @expected[index]
      return Float::INFINITY unless got.finite? && expected.finite?

      off = (got - expected).abs
      return off unless @angle

      off = off.remainder(TURN)
      [off, TURN - off].min
    end

    # Flattens a number, a vector or a matrix, row by row.
    def numbers(thing)
      case thing
      when Numeric then [Float(thing)]
      when String, Hash, nil then refuse(thing)
      else
        refuse(thing) unless thing.respond_to?(:to_a)
        thing.to_a.flat_map { |element| numbers(element) }
      end
    end

    def refuse(thing)
      raise TypeError, "#{thing.inspect} is neither a number nor an array of numbers"
    end
  end
end
