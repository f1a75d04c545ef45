Feature: Arm
  Scenario: The arm moves
    Given an arm
    When it moves to 3
    Then it is at 3

  Scenario: The arm is stuck
    Given an arm
    When it moves to 3
    Then it is at 4

  Scenario Outline: Positions
    Given an arm
    When it moves to <position>
    Then it is at <position>

    Examples:
      | position |
      | 1        |
      | 2        |

  Scenario: A step is missing
    Given a leg
