--  SPDX-License-Identifier: Apache-2.0

with Ada.Numerics;
with Interfaces.C;
with RobotTestingFramework.ABI;
with RobotTestingFramework.Host;
with System;

package body RobotTestingFramework.Near is

   --  Above this many numbers only the text is sent: a line of the protocol has a limit.
   Max_Numbers : constant := 100_000;

   Turn : constant := 2.0 * Ada.Numerics.Pi;

   --  In UTF-8, the host's encoding.
   Plus_Minus : constant String := Character'Val (16#C2#) & Character'Val (16#B1#);

   function Is_Finite (Number : Long_Float) return Boolean is
     (abs Number <= Long_Float'Last);

   function Is_Finite (Compared : Comparison; Index : Positive) return Boolean is
     (Is_Finite (Compared.Got (Index)) and then Is_Finite (Compared.Expected (Index)));

   function Difference (Compared : Comparison; Index : Positive) return Long_Float is
      Plain : constant Long_Float := Compared.Got (Index) - Compared.Expected (Index);
   begin
      return abs (if Compared.Angle then Long_Float'Remainder (Plain, Turn) else Plain);
   end Difference;

   --  The index with the largest difference; non-finite numbers come first.
   function Worst (Compared : Comparison) return Positive is
      Found : Positive := 1;
   begin
      for Index in 1 .. Compared.Count loop
         if not Is_Finite (Compared, Index) then
            return Index;
         elsif Difference (Compared, Index) > Difference (Compared, Found) then
            Found := Index;
         end if;
      end loop;
      return Found;
   end Worst;

   function Image (Number : Natural) return String is
      Padded : constant String := Number'Image;
   begin
      return Padded (Padded'First + 1 .. Padded'Last);
   end Image;

   --  Describes the problem; empty if both are near.
   function Problem (Compared : Comparison) return String is
      Index : Positive;
   begin
      if Compared.Count /= Compared.Expected_Count then
         return "got " & Image (Compared.Count) & " values, expected "
           & Image (Compared.Expected_Count);
      elsif Compared.Count = 0 then
         return "";
      end if;
      Index := Worst (Compared);
      if Is_Finite (Compared, Index)
        and then Difference (Compared, Index) <= Compared.Tolerance
      then
         return "";
      end if;
      return "got " & Host.Image (Compared.Got (Index))
        & ", expected " & Host.Image (Compared.Expected (Index))
        & " " & Plus_Minus & " " & Host.Image (Compared.Tolerance)
        & (if Is_Finite (Compared, Index)
           then " (off by " & Host.Image (Difference (Compared, Index)) & ")"
           else "")
        & (if Compared.Scalar then "" else " at index " & Image (Index - 1));
   end Problem;

   procedure Report
     (Compared : Comparison;
      What     : String;
      File     : String;
      Line     : Natural;
      Holds    : out Boolean)
   is
      use type Interfaces.C.size_t;
      use type Interfaces.Integer_64;
      Good_Tolerance : constant Boolean :=
        Is_Finite (Compared.Tolerance) and then Compared.Tolerance >= 0.0;
      Wrong          : constant String  := Problem (Compared);
      Has_Worst      : constant Boolean :=
        not Compared.Scalar and then Compared.Count = Compared.Expected_Count
        and then Compared.Count > 0;
      Sent           : aliased constant ABI.Comparison :=
        (Size           => ABI.Comparison'Size / System.Storage_Unit,
         Expected       => Compared.Expected'Address,
         Expected_Count => Interfaces.C.size_t (Compared.Expected_Count),
         Got            => Compared.Got'Address,
         Got_Count      => Interfaces.C.size_t (Compared.Count),
         Tolerance      => Interfaces.C.double (Compared.Tolerance),
         Worst          =>
           (if Has_Worst then Interfaces.Integer_64 (Worst (Compared)) - 1 else -1));
   begin
      if not Good_Tolerance then
         raise Constraint_Error
           with "the tolerance " & Host.Image (Compared.Tolerance)
           & " is not a finite number from 0";
      end if;
      Holds := Wrong = "";
      Host.Send
        (Kind       => (if Holds then ABI.Check else ABI.Failure),
         Content    => (if Holds then What else What & ": " & Wrong),
         File       => File,
         Line       => Line,
         Comparison =>
           (if Compared.Count + Compared.Expected_Count > Max_Numbers
            then System.Null_Address else Sent'Address));
   end Report;

end RobotTestingFramework.Near;
